// SPDX-License-Identifier: BSD-3-Clause
// A detector finds a corner only to about a pixel of its pyramid level. So a matched keypoint is moved to the place
// where its patch looks as in the first keyframes that observed the landmark, if their images are kept
// (FrontSubmap::images). If no patch agrees, the keypoint stays where it was found.
#pragma once

#include <memory>
#include <vector>

#include "front_tracker/frame/front_submap.h"
#include "front_tracker/patches/patch_templates.h"

namespace rumi::front_tracker {

// Aligns all matched keypoints of the frame, at its present pose. Returns false, and does nothing, if no images are
// kept. `templates` keeps the templates from frame to frame.
bool align_keypoints(const FrontSubmap& submap, Frame* frame, PatchTemplates* templates);

// Aligns keypoints of one keyframe, one by one, as they become observations. The map's mutex must be held as long as
// the aligner exists.
class KeyframeAligner {
 public:
  KeyframeAligner(FrontSubmap& submap, int keyframe_id) : submap_(submap), id_(keyframe_id) {}
  KeyframeAligner(const KeyframeAligner&) = delete;
  KeyframeAligner& operator=(const KeyframeAligner&) = delete;
  ~KeyframeAligner();
  // Returns false if the keypoint stays where it is.
  bool align(int keypoint, const Eigen::Vector3d& position, const std::vector<Observation>& references);

 private:
  FrontSubmap& submap_;
  int id_;
  std::shared_ptr<Features> moved_;  // the keyframe's new features, once a keypoint has moved
};

}  // namespace rumi::front_tracker
