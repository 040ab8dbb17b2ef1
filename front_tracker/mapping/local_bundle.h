// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "front_tracker/frame/front_submap.h"
#include "front_tracker/mapping/mapping_options.h"
#include "slam/optimization/bundle_adjustment.h"

namespace rumi::front_tracker {

// Local bundle adjustment in three steps, so that the submap need not be locked during the second: collect a copy of
// the keyframe's surroundings, solve, write back what still exists. Of every so many keyframes (bundle_wide_every) the
// surroundings are wide: in fast motion those that are free otherwise are only three seconds, and what they leave
// undone adds up.
class LocalBundle {
 public:
  LocalBundle(const Camera& camera, const MappingOptions& options) : camera_(camera), options_(options) {}
  void collect(const FrontSubmap& submap, int keyframe_id);
  bool solve();
  // Also removes the observations that do not fit and the landmarks left with fewer than two.
  void apply(FrontSubmap& submap) const;

 private:
  Camera camera_;
  MappingOptions options_;
  BundleProblem problem_;
  std::vector<BundleProblem::Observation> impossible_;  // of points behind the camera: left out, and removed by apply()
  std::vector<int> keyframe_ids_;                       // of the views
  std::vector<int> landmark_ids_;                       // of the points
};

}  // namespace rumi::front_tracker
