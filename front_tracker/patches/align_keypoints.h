// SPDX-License-Identifier: BSD-3-Clause
// A corner detector finds a corner within a pixel of its pyramid level, here and there. What is matched is therefore
// moved to where the patch around it looks as in the first keyframes that saw the landmark, as far as their images are
// kept (FrontSubmap::images). Where none agrees a keypoint stays where it was found.
#pragma once

#include <memory>
#include <vector>

#include "front_tracker/frame/front_submap.h"
#include "front_tracker/patches/patch_templates.h"

namespace rumi::front_tracker {

// All that the frame is matched to, at its present pose. False, and nothing done, where no images are kept. `templates`
// are those of the submap's frames before.
bool align_keypoints(const FrontSubmap& submap, Frame* frame, PatchTemplates* templates);

// Keypoints of one keyframe, one by one, as they become observations. Hold the map's mutex while there is one.
class KeyframeAligner {
 public:
  KeyframeAligner(FrontSubmap& submap, int keyframe_id) : submap_(submap), id_(keyframe_id) {}
  KeyframeAligner(const KeyframeAligner&) = delete;
  KeyframeAligner& operator=(const KeyframeAligner&) = delete;
  ~KeyframeAligner();
  // False: it stays where it is.
  bool align(int keypoint, const Eigen::Vector3d& position, const std::vector<Observation>& references);

 private:
  FrontSubmap& submap_;
  int id_;
  std::shared_ptr<Features> moved_;  // the keyframe's, once one has moved
};

}  // namespace rumi::front_tracker
