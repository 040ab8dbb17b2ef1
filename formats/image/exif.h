// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

namespace rumi {

// How a JPEG is to be turned to be shown, 1 to 8 (EXIF); 1, as it is, if it does not say.
int exif_orientation(std::span<const uint8_t> jpeg);

}  // namespace rumi
