// SPDX-License-Identifier: BSD-3-Clause
// Finds more observations of the map's points: projects each point into every view that should see it, and compares
// descriptors. If the map is about right, this connects submaps of different times that saw the same place.
#pragma once

#include "map_server/model/map_model.h"

namespace rumi::map_server {

struct AssociationOptions {
  double radius_px = 40;           // search radius at octave 0, px; loops may be off by this much
  int max_distance = 50;           // largest Hamming distance
  double max_ratio = 0.8;          // largest ratio of the best distance to the second best
  double max_view_angle_deg = 45;  // largest angle from a view's ray to the mean of the point's rays
  double max_depth_ratio = 0.1;    // largest log ratio of the depths of two fused points in one view
};

struct AssociationReport {
  int observed = 0;  // new observations, at keypoints that observed no point
  int fused = 0;     // points fused into another one
};

// Searches in these views, or in all if `views` is empty.
AssociationReport associate(const AssociationOptions& options, const std::vector<int>& views, MapModel* model);

}  // namespace rumi::map_server
