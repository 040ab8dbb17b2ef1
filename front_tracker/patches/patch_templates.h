// SPDX-License-Identifier: BSD-3-Clause
// What landmarks should look like in the next frame: making a patch's template costs more than finding it, and from one
// frame to the next it hardly changes.
#pragma once

#include <cstdint>
#include <unordered_map>

#include "slam/features/patch_template.h"
#include "slam/map/submap.h"

namespace rumi::front_tracker {

class PatchTemplates {
 public:
  // What is asked for: how the patch around a keyframe's keypoint appears in a frame.
  struct Patch {
    Observation seen;
    Eigen::Vector2f pixel;                // of the keypoint
    Eigen::Matrix2f frame_from_keyframe;  // as for make_patch_template
    uint8_t octave = 0;                   // of the frame's image; both have the same pyramid
  };

  // The template of an earlier frame if that was of the same octave and distorted the same to within 2 %, else a new
  // one. Null if there is none. Valid until the next call of anything.
  const PatchTemplate* find(const ImagePyramid& keyframe_images, const Patch& patch);
  // Forgets what was not asked for in the last 8 frames.
  void end_frame();
  void clear() { entries_.clear(); }
  size_t size() const { return entries_.size(); }

 private:
  struct Entry {
    Patch patch;
    std::optional<PatchTemplate> made;
    int64_t used = 0;
  };
  std::unordered_map<uint64_t, Entry> entries_;  // by keyframe, keypoint and octave
  int64_t frame_ = 0;
};

}  // namespace rumi::front_tracker
