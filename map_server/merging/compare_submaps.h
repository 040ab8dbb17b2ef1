// SPDX-License-Identifier: BSD-3-Clause
// Compares two submaps made of some of the same images: whether they agree, and how they lie to each other.
#pragma once

#include "map_server/alignment/submap_alignment.h"
#include "map_server/links/link_graph.h"
#include "slam/map/submap.h"

namespace rumi::map_server {

struct PairOptions {
  AlignmentOptions alignment;
  double joint_sigma_rotation_deg = 0.2;  // between the poses of an image in two submaps
  double joint_sigma_translation = 0.01;  // the same, of the median depth
  double joint_sigma_log_scale = 0.02;    // at least
};

ComparedPair compare_submaps(const Submap& a, const Submap& b, const PairOptions& options);

}  // namespace rumi::map_server
