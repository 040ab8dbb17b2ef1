// SPDX-License-Identifier: BSD-3-Clause
// A front submap often bends before it is lost, or before it has settled: in its last, or first, keyframes the scale
// runs away or poses are wrong. Its other end is right, and a back submap of the same images may be joined there. So it
// is with the outer end of a back submap, whose last images few others see.
#pragma once

#include <vector>

#include "map_server/alignment/correspondences.h"

namespace rumi::map_server {

// Of Correspondences::keyframes.
struct SharedRun {
  size_t first = 0, count = 0;
  bool is_back_bent = false;  // what is left out is an end of the back submap that lies within the front submap
};

// What may be left of the shared keyframes without a bent end, the longest first, and then without both ends: of a
// front and a back submap. Never fewer than four, or a third of them.
std::vector<SharedRun> runs_beside_bent_end(const Submap& a, const Submap& b, const Correspondences& common);

// Is it an end that is bent, and not the back submap that is torn? True if the back submap hangs
// together between any two shared keyframes: it sees at least `min_landmarks` both before and after within
// `max_error_px` (octave 0), and these are at least `min_ratio` of all that it sees both before and after.
bool back_submap_holds(const Submap& a, const Submap& b, const Correspondences& common, int min_landmarks,
                       double min_ratio, double max_error_px);

// What the two have in common in these keyframes.
Correspondences part_of(const Correspondences& common, const SharedRun& run);

}  // namespace rumi::map_server
