// SPDX-License-Identifier: BSD-3-Clause
// Colours of landmarks in files for other programs (PLY, COLMAP).
#pragma once

#include <cstdint>
#include <map>

#include "map_server/atlas/placement.h"

namespace rumi::map_server {

struct Colour {
  uint8_t red = 0, green = 0, blue = 0;
  bool operator==(const Colour&) const = default;
};
Colour submap_colour(SubmapKey key);

// Colours of landmarks, as seen in the images. A landmark without one is written in the colour of its submap.
using LandmarkColours = std::map<LandmarkRef, Colour>;
Colour colour_of(const LandmarkRef& landmark, const LandmarkColours& colours);

}  // namespace rumi::map_server
