// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/outputs/colours.h"

#include <algorithm>
#include <cmath>

namespace rumi::map_server {

// Hues are a golden angle apart, so that submaps with neighbouring numbers have very different colours.
Colour submap_colour(SubmapKey key) {
  const double hue = std::fmod(0.58 + 0.61803398875 * std::abs(static_cast<double>(key.id)), 1.0);
  const double strength = key.id < 0 ? 0.6 : 1.0;
  const auto channel = [&](double offset) {
    const double k = std::fmod(offset + hue * 6.0, 6.0);
    const double saturation = 0.75;
    const double value = 1.0 - saturation * std::max(0.0, std::min({k, 4.0 - k, 1.0}));
    return static_cast<uint8_t>(std::lround(255 * strength * value));
  };
  return {channel(5), channel(3), channel(1)};
}

Colour colour_of(const LandmarkRef& landmark, const LandmarkColours& colours) {
  const auto seen = colours.find(landmark);
  return seen == colours.end() ? submap_colour(landmark.submap) : seen->second;
}

}  // namespace rumi::map_server
