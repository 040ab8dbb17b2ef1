// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/matching/window_matches.h"

#include <Eigen/Dense>
#include <algorithm>
#include <numeric>
#include <set>

#include "base/running/stage_clock.h"
#include "slam/numeric/median.h"
#include "slam/numeric/union_find.h"

namespace rumi::ruminator {

namespace {

using PairSet = std::set<std::pair<int, int>>;

// A pair far apart in time is matched completely only if its kPreviewKeypoints keypoints of the largest scale have at
// least kPreviewMatches matches (Wu, "Towards linear-time incremental structure from motion", 3DV 2013).
constexpr int kPreviewKeypoints = 150;
constexpr int kPreviewMatches = 6;

// Returns pairs far apart in time for which the preview finds matches: for each image those with most of them.
PairSet select_far_pairs(const std::vector<SiftFeatures>& images, const PairSelection& selection,
                         const std::atomic<bool>& cancel) {
  const int count = static_cast<int>(images.size());
  // By image: minus the number of matches, and the other image.
  std::vector<std::vector<std::pair<int, int>>> candidates(images.size());
  for (int i = 0; i < count && !cancel; ++i) {
    for (int j = i + selection.near + 1; j < count; ++j) {
      const auto matches = static_cast<int>(match_sift(images[i], images[j], kPreviewKeypoints).size());
      if (matches < kPreviewMatches) continue;
      candidates[i].emplace_back(-matches, j);
      candidates[j].emplace_back(-matches, i);
    }
  }
  PairSet pairs;
  for (int i = 0; i < count; ++i) {
    std::sort(candidates[i].begin(), candidates[i].end());
    for (size_t k = 0; k < candidates[i].size() && k < static_cast<size_t>(selection.far); ++k)
      pairs.insert(std::minmax(i, candidates[i][k].second));
  }
  return pairs;
}

}  // namespace

std::vector<ImagePair> match_window(const Camera& camera, const std::vector<SiftFeatures>& images,
                                    const PairSelection& selection, const std::function<void(double)>& progress,
                                    const std::atomic<bool>& cancel) {
  const StageClock clock("ruminator.match");
  PairSet selected = select_far_pairs(images, selection, cancel);
  const int count = static_cast<int>(images.size());
  for (int i = 0; i < count; ++i)
    for (int j = i + 1; j < count && j <= i + selection.near; ++j) selected.emplace(i, j);

  std::vector<ImagePair> pairs;
  size_t done = 0;
  for (const auto& [i, j] : selected) {
    if (cancel) break;
    const IndexPairs matches = match_sift(images[i], images[j]);
    IndexPairs verified = verify_matches(camera, images[i], images[j], matches);
    if (!verified.empty()) pairs.push_back({i, j, std::move(verified)});
    progress(static_cast<double>(++done) / static_cast<double>(selected.size()));
  }
  return pairs;
}

double parallax_px(const Camera& camera, const std::vector<SiftFeatures>& images, const ImagePair& pair) {
  std::vector<Eigen::Vector3d> first, second;
  for (const auto& [i, j] : pair.matches) {
    first.push_back(camera.ray(images[pair.first].undistorted[i]).normalized());
    second.push_back(camera.ray(images[pair.second].undistorted[j]).normalized());
  }
  // Finds the rotation that best aligns the directions (Kabsch), twice. The second time, matches that moved much have
  // less weight, because they are probably near the camera.
  std::vector<double> weight(first.size(), 1), angle(first.size());
  for (int round = 0; round < 2; ++round) {
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (size_t k = 0; k < first.size(); ++k) sum += weight[k] * second[k] * first[k].transpose();
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant();
    const Eigen::Matrix3d rotation =
        svd.matrixU() * Eigen::Vector3d(1, 1, sign).asDiagonal() * svd.matrixV().transpose();
    for (size_t k = 0; k < first.size(); ++k) {
      angle[k] = (rotation * first[k]).cross(second[k]).norm();
      weight[k] = 1 / (angle[k] + 1e-3);
    }
  }
  if (angle.empty()) return 0;
  return median(&angle) * 0.5 * (camera.fx + camera.fy);
}

std::vector<int> connected_images(int images, const std::vector<ImagePair>& pairs, int min_matches) {
  UnionFind connected(images);
  for (const ImagePair& pair : pairs)
    if (static_cast<int>(pair.matches.size()) >= min_matches) connected.unite(pair.first, pair.second);
  const auto root = [&connected](int i) { return static_cast<int>(connected.find(i)); };

  std::vector<int> size(images, 0), roots;
  for (int i = 0; i < images; ++i)
    if (size[root(i)]++ == 0) roots.push_back(root(i));
  std::stable_sort(roots.begin(), roots.end(), [&size](int a, int b) { return size[a] > size[b]; });
  std::vector<int> group(images);
  for (int i = 0; i < images; ++i)
    group[i] = static_cast<int>(std::find(roots.begin(), roots.end(), root(i)) - roots.begin());
  return group;
}

}  // namespace rumi::ruminator
