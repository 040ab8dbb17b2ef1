// SPDX-License-Identifier: BSD-3-Clause
// Compares two submaps made of some of the same images: do they agree, and how do they lie relative to each other?
#pragma once

#include "map_server/alignment/submap_alignment.h"
#include "map_server/links/link_graph.h"
#include "slam/map/submap.h"

namespace rumi::map_server {

struct PairOptions {
  AlignmentOptions alignment;
  double joint_sigma_rotation_deg = 0.2;  // standard deviation of the rotation between an image's poses in two submaps
  double joint_sigma_translation = 0.01;  // standard deviation of their distance, as a share of the median depth
  double joint_sigma_log_scale = 0.02;    // standard deviation of the log scale between them, at least
};

// The caller notes it with the pair that it compares.
SharedState shared_state(const Submap& a, const Submap& b);
ComparedPair compare_submaps(const Submap& a, const Submap& b, const PairOptions& options);

}  // namespace rumi::map_server
