// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/rebuild/window_prospects.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <map>

#include "base/running/stage_clock.h"
#include "bus/wire/image_masks.h"
#include "bus/wire/working_image.h"
#include "ruminator/matching/pair_motion.h"
#include "slam/features/lens_mask.h"

namespace rumi::ruminator {
namespace {

enum class Part { kApproach, kGap, kDeparture };

std::map<int64_t, Part> parts(const RuminationWindow& window) {
  std::map<int64_t, Part> part_of;
  for (const Sample& sample : window.approach) part_of[sample.utime_us] = Part::kApproach;
  for (const Sample& sample : window.gap) part_of[sample.utime_us] = Part::kGap;
  for (const Sample& sample : window.departure) part_of[sample.utime_us] = Part::kDeparture;
  return part_of;
}

// A look at so many images of a long gap: with fewer keypoints in each of them it is blind.
constexpr size_t kLooks = 6;
constexpr size_t kMinKeypoints = 50;
constexpr size_t kFarthestPairs = 3;  // of each image, that are asked for depth
constexpr size_t kWithDepth = 3;      // images that a model needs, and that must show it

// Indices of the pairs worth asking, those far apart in time first: what moves slowly shows there.
std::vector<size_t> telling_pairs(const Camera& camera, const std::vector<SiftFeatures>& images,
                                  const std::vector<ImagePair>& pairs, const std::set<int>& which) {
  std::map<int, std::vector<size_t>> of_image;
  const auto distance = [&](size_t p) { return std::abs(pairs[p].second - pairs[p].first); };
  const auto farther = [&](size_t a, size_t b) { return distance(a) > distance(b); };
  for (size_t p = 0; p < pairs.size(); ++p) {
    if (!which.contains(pairs[p].first) || !which.contains(pairs[p].second)) continue;
    of_image[pairs[p].first].push_back(p);
    of_image[pairs[p].second].push_back(p);
  }
  std::set<size_t> telling;
  for (auto& [image, all] : of_image) {
    std::map<size_t, double> parallax;
    for (const size_t p : all) parallax[p] = parallax_px(camera, images, pairs[p]);
    telling.insert(
        *std::max_element(all.begin(), all.end(), [&](size_t a, size_t b) { return parallax[a] < parallax[b]; }));
    std::stable_sort(all.begin(), all.end(), farther);
    telling.insert(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(std::min(all.size(), kFarthestPairs)));
  }
  std::vector<size_t> sorted(telling.begin(), telling.end());
  std::stable_sort(sorted.begin(), sorted.end(), farther);
  return sorted;
}

}  // namespace

std::string find_no_depth(const Camera& camera, const std::vector<SiftFeatures>& images,
                          const std::vector<ImagePair>& pairs, const std::set<int>& which,
                          const std::atomic<bool>& cancel) {
  const StageClock clock("ruminator.look");
  std::set<int> with_depth;
  for (const size_t p : telling_pairs(camera, images, pairs, which)) {
    const auto& [first, second, matches] = pairs[p];
    if (cancel) return "";
    if (with_depth.contains(first) && with_depth.contains(second)) continue;
    const PairMotion motion = judge_motion(camera, images[first].undistorted, images[second].undistorted, matches);
    if (motion.kind != MotionKind::kDepth) continue;
    with_depth.insert({first, second});
    if (with_depth.size() >= kWithDepth) return "";
  }
  return fmt::format("the camera turned or stood still: of {} images {} show depth", which.size(), with_depth.size());
}

std::string find_blind_gap(const WindowJob& job, const BuildOptions& options) {
  const auto part_of = parts(job.window);
  std::vector<const image_t*> gap;
  for (const image_t& image : job.images)
    if (const auto it = part_of.find(image.utime); it != part_of.end() && it->second == Part::kGap)
      gap.push_back(&image);
  // A short gap costs little, and what is around it may overlap.
  if (gap.size() < 2 * kLooks) return "";
  const Camera camera = working_camera(job.camera, options.max_image_side);
  MaskReader masks(lens_mask(camera));
  size_t most = 0;
  for (size_t i = 0; i < kLooks; ++i) {
    const image_t& image = *gap[i * (gap.size() - 1) / (kLooks - 1)];
    const cv::Mat grey = decode_working_image(image, job.camera, camera).value_or(cv::Mat());
    if (grey.empty()) continue;
    const ImageMask& mask = masks.read(image, grey.size());
    most = std::max(most, extract_sift(grey, camera, options.sift_keypoints, mask).size());
    if (most >= kMinKeypoints) return "";
  }
  return fmt::format("nothing to be seen in the gap: of {} images looked at none has more than {} keypoints", kLooks,
                     most);
}

std::string find_hopeless(const WindowJob& job, const Camera& camera, const std::vector<int64_t>& utimes_us,
                          const std::vector<SiftFeatures>& images, const std::vector<ImagePair>& pairs,
                          const BuildOptions& options) {
  const int count = static_cast<int>(images.size());
  const std::vector<int> group = connected_images(count, pairs, kMinInliers);
  if (std::count(group.begin(), group.end(), 0) < 3)
    return fmt::format("of {} images no three have enough in common", count);
  const bool has_moved = std::any_of(pairs.begin(), pairs.end(), [&](const ImagePair& pair) {
    return parallax_px(camera, images, pair) >= options.min_parallax_px;
  });
  if (!has_moved) return fmt::format("the camera turned or stood still: no parallax between {} images", count);

  const auto part_of = parts(job.window);
  std::map<int, std::map<Part, int>> in_group;
  int in_gap = 0;
  for (int i = 0; i < count; ++i) {
    const auto part = part_of.find(utimes_us[i]);
    if (part == part_of.end()) continue;
    ++in_group[group[i]][part->second];
    in_gap += part->second == Part::kGap;
  }
  const bool has_tracked = !job.window.approach.empty() || !job.window.departure.empty();
  const bool is_tied = std::any_of(in_group.begin(), in_group.end(), [has_tracked](auto& entry) {
    auto& n = entry.second;
    if (!has_tracked) return n[Part::kGap] >= 3;
    const bool is_tracked = n[Part::kApproach] + n[Part::kDeparture] > 0;
    return is_tracked && is_useful(n[Part::kApproach], n[Part::kGap], n[Part::kDeparture]);
  });
  if (!is_tied)
    return fmt::format("none of the {} images of the gap has enough in common with the images around it", in_gap);
  return "";
}

bool is_useful(int approach, int gap, int departure) {
  constexpr int kBridgehead = 3;  // frames on either side: enough to align a submap to
  return gap > 0 || (approach >= kBridgehead && departure >= kBridgehead);
}

}  // namespace rumi::ruminator
