// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/rebuild/first_look.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <optional>
#include <set>

#include "base/running/stage_clock.h"
#include "ruminator/matching/pair_motion.h"
#include "ruminator/matching/sift_matching.h"
#include "slam/numeric/union_find.h"

namespace rumi::ruminator {
namespace {

// look_at_gap() examines kGapLooks images. The gap is blind if none of them has kMinKeypoints keypoints.
constexpr size_t kGapLooks = 6;

// look_at_motion() begins with kFirstLooks images spread evenly over the window. Between neighbours that have too
// little in common it adds images, up to kMostLooks in all.
constexpr size_t kFirstLooks = 8, kMostLooks = 16;

class Looker {
 public:
  Looker(const Camera& camera, WindowImages& images, const std::atomic<bool>& cancel)
      : camera_(camera), images_(images), cancel_(cancel), same_view_(images.size()) {}

  size_t looks() const { return looked_at_.size(); }
  bool has_seen(size_t image) const { return looked_at_.contains(image); }

  // Compares the image with those examined before. Returns false if a pair shows depth, or if the look is cancelled.
  bool look_at(size_t image) {
    const SiftFeatures* const features = images_.features(image);
    if (!features) return true;
    for (const auto& [other, seen] : looked_at_) {
      if (cancel_) return false;
      const PairMotion motion =
          judge_motion(camera_, seen->undistorted, features->undistorted, match_sift(*seen, *features));
      if (motion.kind == MotionKind::kDepth) return false;
      note_evidence(other, image, motion);
      note_evidence(image, other, motion);
      if (motion.kind == MotionKind::kUnknown) continue;
      same_view_.unite(other, image);
      turns_ = turns_ || motion.kind == MotionKind::kTurn;
    }
    looked_at_.emplace(image, features);
    return true;
  }

  // Returns the image in the middle between two neighbours that are not connected. Returns nullopt if all are
  // connected, or if there is no image between the first two that are not.
  std::optional<size_t> next() {
    for (auto a = looked_at_.begin(); a != looked_at_.end(); ++a) {
      const auto b = std::next(a);
      if (b == looked_at_.end()) break;
      const size_t middle = (a->first + b->first) / 2;
      if (same_view_.find(a->first) != same_view_.find(b->first) && middle != a->first) return middle;
    }
    return std::nullopt;
  }

  // Returns an Error if rotations connect all images, and the pairs farthest apart in time are no evidence for depth.
  Result<> verdict() {
    double evidence = 0;
    for (const auto& [image, farthest] : farthest_) evidence += farthest.evidence;
    if (looked_at_.size() < 2 || evidence >= 0) return {};
    const size_t first = same_view_.find(looked_at_.begin()->first);
    for (const auto& [image, features] : looked_at_)
      if (same_view_.find(image) != first) return {};
    return Error{fmt::format("the camera {}: {} images from begin to end show no depth",
                             turns_ ? "only turns" : "stands still", looked_at_.size())};
  }

 private:
  void note_evidence(size_t image, size_t other, const PairMotion& motion) {
    const size_t distance = std::max(image, other) - std::min(image, other);
    Farthest& farthest = farthest_[image];
    if (motion.evidence != 0 && distance > farthest.distance) farthest = {distance, motion.evidence};
  }

  const Camera& camera_;
  WindowImages& images_;
  const std::atomic<bool>& cancel_;
  std::map<size_t, const SiftFeatures*> looked_at_;  // by index in the job
  UnionFind same_view_;                              // groups of images connected by rotations of the camera
  bool turns_ = false;
  struct Farthest {
    size_t distance = 0;
    double evidence = 0;  // evidence for depth, see PairMotion
  };
  // For each image the farthest pair that still matches, which shows depth if any pair does.
  std::map<size_t, Farthest> farthest_;
};

std::vector<size_t> images_of_gap(const WindowJob& job) {
  std::set<int64_t> gap;
  for (const Sample& sample : job.window.gap) gap.insert(sample.utime_us);
  std::vector<size_t> images;
  for (size_t i = 0; i < job.images.size(); ++i)
    if (gap.contains(job.images[i].utime)) images.push_back(i);
  return images;
}

}  // namespace

Result<> look_at_gap(const WindowJob& job, WindowImages& images) {
  const std::vector<size_t> gap = images_of_gap(job);
  // A short gap costs little to rebuild, and the images around it may overlap.
  if (gap.size() < 2 * kGapLooks) return {};
  size_t most = 0;
  for (size_t i = 0; i < kGapLooks; ++i) {
    const SiftFeatures* const features = images.features(gap[i * (gap.size() - 1) / (kGapLooks - 1)]);
    if (!features) continue;
    most = std::max(most, features->size());
    if (most >= kMinKeypoints) return {};
  }
  return Error{fmt::format("nothing to be seen in the gap: of {} images looked at none has more than {} keypoints",
                           kGapLooks, most)};
}

Result<> look_at_motion(const Camera& camera, WindowImages& images, const std::atomic<bool>& cancel) {
  const StageClock clock("ruminator.look");
  Looker looker(camera, images, cancel);
  const size_t all = images.size(), looks = std::min(all, kFirstLooks);
  for (size_t k = 0; k < looks; ++k)
    if (!looker.look_at(k * (all - 1) / std::max<size_t>(looks - 1, 1))) return {};
  while (looker.looks() < kMostLooks) {
    const std::optional<size_t> next = looker.next();
    if (!next) break;
    if (!looker.look_at(*next)) return {};
    if (!looker.has_seen(*next)) return {};  // a broken image: it is unknown what lies between its neighbours
  }
  return cancel ? Result<>() : looker.verdict();
}

}  // namespace rumi::ruminator
