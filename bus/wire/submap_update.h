// SPDX-License-Identifier: BSD-3-Clause
// Converts submaps to and from messages. An update holds what changed since a revision; see lcmtypes/submap.lcm.
#pragma once

#include "base/result.h"
#include "lcmtypes/rumi/submap_update_t.hpp"
#include "slam/map/submap.h"

namespace rumi {

// Returns everything in the submap that changed after base_revision (0: all of it). If the submap no longer remembers
// which elements were removed since then, the update also holds all of it, and its base_revision is 0.
submap_update_t make_submap_update(const Submap& submap, int64_t base_revision);

// Brings the submap (empty, or an earlier revision of the same one) to update.revision; an update with base_revision 0
// replaces everything in it. An Error names the field and its value, and leaves the submap untouched: keys differ;
// base_revision is beyond the submap's revision; a number is not finite; a count, index or id does not fit; the
// calibration is bad. An update that is not newer than the submap is no Error and changes nothing.
Result<> apply_submap_update(const submap_update_t& update, Submap* submap);

}  // namespace rumi
