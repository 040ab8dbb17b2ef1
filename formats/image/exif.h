// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

namespace rumi {

// Returns the orientation in which a JPEG should be shown, 1 to 8 (EXIF); 1, as stored, if the file does not say.
int exif_orientation(std::span<const uint8_t> jpeg);

}  // namespace rumi
