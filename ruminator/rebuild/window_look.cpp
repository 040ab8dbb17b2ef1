// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/rebuild/window_look.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>

#include "base/running/stage_clock.h"
#include "bus/wire/image_masks.h"
#include "bus/wire/working_image.h"
#include "ruminator/matching/pair_motion.h"
#include "slam/features/lens_mask.h"
#include "slam/numeric/union_find.h"

namespace rumi::ruminator {
namespace {

// At first, evenly spread; and in all, where neighbours among them have too little in common and more are looked at
// between them.
constexpr size_t kFirstLooks = 8, kMostLooks = 16;

class Looker {
 public:
  Looker(const WindowJob& job, const Camera& camera, const BuildOptions& options, const std::atomic<bool>& cancel,
         WindowLook* look)
      : job_(job),
        camera_(camera),
        o_(options),
        cancel_(cancel),
        look_(*look),
        masks_(lens_mask(camera)),
        same_view_(job.images.size()) {}

  // False: a pair of images shows depth, or the look is called off.
  bool look_at(size_t image) {
    const cv::Mat grey = decode_working_image(job_.images[image], job_.camera, camera_).value_or(cv::Mat());
    if (grey.empty()) return true;
    const ImageMask& mask = masks_.read(job_.images[image], grey.size());
    const SiftFeatures features = extract_sift(grey, camera_, o_.sift_keypoints, mask);
    for (const auto& [other, seen] : look_.features) {
      if (cancel_) return false;
      const PairMotion motion =
          judge_motion(camera_, seen.undistorted, features.undistorted, match_sift(seen, features));
      if (motion.kind == MotionKind::kDepth) {
        look_.features.emplace(image, features);
        return false;
      }
      note_evidence(other, image, motion);
      note_evidence(image, other, motion);
      if (motion.kind == MotionKind::kUnknown) continue;
      same_view_.unite(other, image);
      turns_ = turns_ || motion.kind == MotionKind::kTurn;
    }
    look_.features.emplace(image, features);
    return true;
  }

  // The middle of two neighbours that do not hang together; nothing if all do, or there is nothing between them.
  std::optional<size_t> next() {
    for (auto a = look_.features.begin(); a != look_.features.end(); ++a) {
      const auto b = std::next(a);
      if (b == look_.features.end()) break;
      const size_t middle = (a->first + b->first) / 2;
      if (same_view_.find(a->first) != same_view_.find(b->first) && middle != a->first) return middle;
    }
    return std::nullopt;
  }

  // All images hang together by turns, and those far apart do not speak for depth.
  std::string verdict() {
    double evidence = 0;
    for (const auto& [image, farthest] : farthest_) evidence += farthest.evidence;
    if (look_.features.size() < 2 || evidence >= 0) return "";
    const size_t first = same_view_.find(look_.features.begin()->first);
    for (const auto& [image, features] : look_.features)
      if (same_view_.find(image) != first) return "";
    return fmt::format("the camera {}: {} images from begin to end show no depth",
                       turns_ ? "only turns" : "stands still", look_.features.size());
  }

 private:
  void note_evidence(size_t image, size_t other, const PairMotion& motion) {
    const size_t distance = std::max(image, other) - std::min(image, other);
    Farthest& farthest = farthest_[image];
    if (motion.evidence != 0 && distance > farthest.distance) farthest = {distance, motion.evidence};
  }

  const WindowJob& job_;
  const Camera& camera_;
  const BuildOptions& o_;
  const std::atomic<bool>& cancel_;
  WindowLook& look_;
  MaskReader masks_;
  UnionFind same_view_;  // images that turns of the camera bring together
  bool turns_ = false;
  struct Farthest {
    size_t distance = 0;
    double evidence = 0;  // of depth
  };
  std::map<size_t, Farthest> farthest_;  // of each image the pair that still matches: it shows depth if any does
};

}  // namespace

WindowLook look_at_motion(const WindowJob& job, const Camera& camera, const BuildOptions& options,
                          const std::atomic<bool>& cancel) {
  const StageClock clock("ruminator.look");
  WindowLook look;
  Looker looker(job, camera, options, cancel, &look);
  const size_t images = job.images.size(), looks = std::min(images, kFirstLooks);
  for (size_t k = 0; k < looks; ++k)
    if (!looker.look_at(k * (images - 1) / std::max<size_t>(looks - 1, 1))) return look;
  while (look.features.size() < kMostLooks) {
    const std::optional<size_t> next = looker.next();
    if (!next) break;
    if (!looker.look_at(*next)) return look;
    if (!look.features.contains(*next)) return look;  // broken
  }
  if (!cancel) look.hopeless = looker.verdict();
  return look;
}

}  // namespace rumi::ruminator
