// SPDX-License-Identifier: BSD-3-Clause
// A front submap often bends before it is lost, or before it has settled: in its last or first keyframes the scale runs
// away or poses are wrong. Its other end is right, and a back submap of the same images may be joined there. A back
// submap may bend at its outer end, because few other images see what its last images see.
#pragma once

#include <vector>

#include "map_server/alignment/correspondences.h"

namespace rumi::map_server {

// A run of Correspondences::keyframes.
struct SharedRun {
  size_t first = 0, count = 0;
  bool is_back_bent = false;  // the run leaves out an end of the back submap that lies within the front submap
};

// The runs of shared keyframes of a front and a back submap that remain without a bent end, the longest first, and then
// those without both ends. A run has at least four keyframes, and a third of the shared ones.
std::vector<SharedRun> runs_beside_bent_end(const Submap& a, const Submap& b, const Correspondences& common);

// True if an end is bent, and not the back submap torn: the back submap hangs together between any two neighbouring
// shared keyframes. There it sees at least `min_landmarks` landmarks both before and after with an error of at most
// `max_error_px` (octave 0), and these are at least `min_ratio` of all that it sees both before and after.
bool back_submap_holds(const Submap& a, const Submap& b, const Correspondences& common, int min_landmarks,
                       double min_ratio, double max_error_px);

// The correspondences in these shared keyframes.
Correspondences part_of(const Correspondences& common, const SharedRun& run);

}  // namespace rumi::map_server
