// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <set>
#include <vector>

#include "front_tracker/frame/front_submap.h"
#include "front_tracker/mapping/mapping_options.h"
#include "slam/optimization/bundle_adjustment.h"

namespace rumi::front_tracker {

// Local bundle adjustment in three steps: collect() copies the keyframe's window, solve() adjusts it, apply() writes
// back those parts that still exist. The submap need not be locked during solve(). For every n-th keyframe
// (bundle_wide_every) the window is wide: in fast motion the usual one spans only three seconds, and the errors that it
// leaves add up.
class LocalBundle {
 public:
  LocalBundle(const Camera& camera, const MappingOptions& options) : camera_(camera), options_(options) {}
  void collect(const FrontSubmap& submap, int keyframe_id);
  bool solve();
  // Writes back the result. Also removes the observations that do not fit, and landmarks that have fewer than two
  // observations left.
  void apply(FrontSubmap& submap) const;

 private:
  struct Window {
    int newest = kNone;
    std::set<int> free;  // keyframes whose poses are adjusted
    int most_fixed = 0;
    std::vector<int> landmarks = {};  // those that the free keyframes observe, ascending
  };
  Window choose_window(const Submap& map, int keyframe_id) const;
  static std::vector<int> choose_fixed(const Submap& map, const Window& window);
  void add_views(const Submap& map, const Window& window);
  void add_points(const FrontSubmap& submap, const std::vector<int>& landmarks);

  Camera camera_;
  MappingOptions options_;
  BundleProblem problem_;
  std::vector<BundleProblem::Observation> impossible_;  // observations of points behind the camera: left out of
                                                        // problem_ and removed by apply()
  std::vector<int> keyframe_ids_;                       // by view
  std::vector<int> landmark_ids_;                       // by point
};

}  // namespace rumi::front_tracker
