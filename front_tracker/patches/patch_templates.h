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
  // A request for the appearance of the patch around a keyframe's keypoint in a frame.
  struct Patch {
    Observation seen;
    Eigen::Vector2f pixel;                // the keypoint's
    Eigen::Matrix2f frame_from_keyframe;  // as for make_patch_template
    uint8_t octave = 0;                   // in the frame's image; both have the same pyramid
  };

  // Returns the template of an earlier frame if it had the same octave and, to 2 %, the same distortion; else a new
  // one. nullptr if none can be made. The pointer is valid until the next call of any method.
  const PatchTemplate* find(const ImagePyramid& keyframe_images, const Patch& patch);
  // Forgets the templates that were not requested in the last 8 frames.
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
