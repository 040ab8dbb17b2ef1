// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/rebuild/proof_of_depth.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <map>

#include "base/running/stage_clock.h"
#include "ruminator/matching/pair_motion.h"
#include "ruminator/matching/window_matches.h"

namespace rumi::ruminator {
namespace {

constexpr size_t kFarthestPairs = 3;  // pairs tested for each image, and the pair with the largest parallax
constexpr size_t kWithDepth = 3;      // least number of images that must show depth; a model needs as many

// Returns the indices of the pairs to test. Pairs far apart in time come first, because there a slow motion is large
// enough.
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

Result<> prove_depth(const Camera& camera, const std::vector<SiftFeatures>& images, const std::vector<ImagePair>& pairs,
                     const std::set<int>& which, const std::atomic<bool>& cancel) {
  const StageClock clock("ruminator.look");
  std::set<int> with_depth;
  for (const size_t p : telling_pairs(camera, images, pairs, which)) {
    const auto& [first, second, matches] = pairs[p];
    if (cancel) return {};
    if (with_depth.contains(first) && with_depth.contains(second)) continue;
    const PairMotion motion = judge_motion(camera, images[first].undistorted, images[second].undistorted, matches);
    if (motion.kind != MotionKind::kDepth) continue;
    with_depth.insert({first, second});
    if (with_depth.size() >= kWithDepth) return {};
  }
  return Error{
      fmt::format("the camera turned or stood still: of {} images {} show depth", which.size(), with_depth.size())};
}

}  // namespace rumi::ruminator
