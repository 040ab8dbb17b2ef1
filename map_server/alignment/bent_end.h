// SPDX-License-Identifier: BSD-3-Clause
// A front submap often bends before it is lost, or before it has settled: in its last or first keyframes the scale runs
// away or poses are wrong. Its other end is right, and a back submap of the same images may be joined there. A back
// submap may bend at its outer end, because few other images see what its last images see.
#pragma once

#include <vector>

#include "map_server/alignment/correspondences.h"

namespace rumi::map_server {

// A range of Correspondences::keyframes.
struct SharedRun {
  size_t first = 0, count = 0;
  bool is_back_bent = false;  // the run leaves out an end of the back submap that lies within the front submap, or both
                              // ends
};

// Returns the runs of shared keyframes of a front and a back submap that remain if one end is left out as bent, the
// longest first; after them the runs that remain if both ends are left out. A run has at least four keyframes, and at
// least a third of the shared ones.
std::vector<SharedRun> runs_beside_bent_end(const Submap& a, const Submap& b, const Correspondences& common);

// Returns true if the back submap holds together, so that the cause of a doubt is a bent end and not a torn back
// submap. For any two neighbouring shared keyframes, the back submap must have at least `min_landmarks` landmarks that
// are observed both before and after that gap with an error of at most `max_error_px` (at octave 0), and these must be
// at least `min_ratio` of all landmarks that are observed both before and after it.
bool back_submap_holds(const Submap& a, const Submap& b, const Correspondences& common, int min_landmarks,
                       double min_ratio, double max_error_px);

// Returns the shared keyframes of `run` with their landmarks, and all frames.
Correspondences part_of(const Correspondences& common, const SharedRun& run);

}  // namespace rumi::map_server
