// SPDX-License-Identifier: BSD-3-Clause
// Finds the similarity that most pairs of landmarks agree with.
#pragma once

#include <optional>
#include <vector>

#include "map_server/places/place_matching.h"
#include "slam/geometry/transform.h"
#include "slam/numeric/consensus.h"

namespace rumi::map_server {

// A pair of landmarks, with the values that scoring a similarity needs.
struct PlaceEquation {
  Eigen::Vector3d point_a, point_b;
  SE3 cam_from_a, cam_from_b;        // poses of the views that saw the points
  Eigen::Vector2d pixel_a, pixel_b;  // undistorted pixels in those views
  double sigma_a_px = 1, sigma_b_px = 1;
};

std::vector<PlaceEquation> make_equations(const PlaceNeighbourhood& a, const PlaceNeighbourhood& b,
                                          const std::vector<PlaceMatch>& matches);

// Returns the larger of the two reprojection errors (a's point in b's view, and the reverse), over sigma; infinite if a
// point is behind a camera.
double reprojection_error_px(const PlaceEquation& equation, const Camera& camera_a, const Camera& camera_b,
                             const Sim3& b_from_a, const Sim3& a_from_b);

// Returns b_from_a, and the indices (ascending) of the equations that agree with it. Considers only the equations with
// indices in `among`. Returns nullopt if no three of them agree. Deterministic.
std::optional<Consensus<Sim3>> find_consensus(const std::vector<PlaceEquation>& equations,
                                              const std::vector<int>& among, const Camera& camera_a,
                                              const Camera& camera_b, double max_error_px, int samples);

}  // namespace rumi::map_server
