// SPDX-License-Identifier: BSD-3-Clause
// Finds points of the map in more images than those that made them: it projects points into every view that should see
// them and compares descriptors. Once the map is about right, this ties together submaps of different times that saw
// the same place.
#pragma once

#include "map_server/model/map_model.h"

namespace rumi::map_server {

struct AssociationOptions {
  double radius_px = 40;   // around the projection, at octave 0; as far as a long loop may be off
  int max_distance = 50;   // Hamming
  double max_ratio = 0.8;  // best over second best
  double max_view_angle_deg =
      45;                        // between the direction of a view and the mean direction from which the point was seen
  double max_depth_ratio = 0.1;  // between the depths of two points that are fused, seen from the same view
};

struct AssociationReport {
  int observed = 0;  // new observations by keypoints that saw nothing
  int fused = 0;     // points
};

// Looks in these views, or in all if `views` is empty.
AssociationReport associate(const AssociationOptions& options, const std::vector<int>& views, MapModel* model);

}  // namespace rumi::map_server
