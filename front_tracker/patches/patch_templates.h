// SPDX-License-Identifier: BSD-3-Clause
// Keeps the templates of landmarks from frame to frame: making a template costs more than finding its patch, and it
// hardly changes.
#pragma once

#include <cstdint>
#include <unordered_map>

#include "slam/features/patch_template.h"
#include "slam/map/submap.h"

namespace rumi::front_tracker {

class PatchTemplates {
 public:
  // The request for a template: how the patch around a keyframe's keypoint appears in a frame.
  struct Patch {
    Observation seen;
    Eigen::Vector2f pixel;                // pixel of the keypoint
    Eigen::Matrix2f frame_from_keyframe;  // image_from_reference of make_patch_template()
    uint8_t octave = 0;                   // level in the frame's image; both images have the same pyramid
  };

  // Returns the template of an earlier frame if that had the same octave and, to 2 %, the same distortion; otherwise a
  // new one. Returns nullptr if none can be made. The pointer is valid until the next call of any method.
  const PatchTemplate* find(const ImagePyramid& keyframe_images, const Patch& patch);
  // To be called after each frame. Forgets the templates that were not requested in the last 8 frames.
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
