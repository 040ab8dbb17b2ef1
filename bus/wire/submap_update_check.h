// SPDX-License-Identifier: BSD-3-Clause
// Checks an update before anything is changed. An Error names what does not fit this submap.
#pragma once

#include "base/result.h"
#include "lcmtypes/rumi/submap_update_t.hpp"
#include "slam/map/submap.h"

namespace rumi {

// Checks whether all that identifies the submap, and the revisions, fit the submap.
Result<> check_update_header(const submap_update_t& update, const Submap& submap);
// Checks everything else. The header must have passed its check, and `camera` must be that of the update's calibration.
Result<> check_update_elements(const submap_update_t& update, const Camera& camera, const Submap& submap);

}  // namespace rumi
