// SPDX-License-Identifier: BSD-3-Clause
// Checks an update before anything is changed. An Error names what does not fit this submap.
#pragma once

#include "base/result.h"
#include "lcmtypes/rumi/submap_update_t.hpp"
#include "slam/map/submap.h"

namespace rumi {

// The submap's identity and the revisions.
Result<> check_update_header(const submap_update_t& update, const Submap& submap);
// Everything else; the header must be right, and the camera is that of its calibration.
Result<> check_update_elements(const submap_update_t& update, const Camera& camera, const Submap& submap);

}  // namespace rumi
