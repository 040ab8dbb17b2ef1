// SPDX-License-Identifier: BSD-3-Clause
// Looks at an update before anything is changed. Both return what is wrong with it for this submap, or an empty string.
#pragma once

#include <string>

#include "lcmtypes/rumi/submap_update_t.hpp"
#include "slam/map/submap.h"

namespace rumi {

// The submap's identity and the revisions.
std::string check_update_header(const submap_update_t& update, const Submap& submap);
// Everything else; the header must be right, and the camera is that of its calibration.
std::string check_update_elements(const submap_update_t& update, const Camera& camera, const Submap& submap);

}  // namespace rumi
