// SPDX-License-Identifier: BSD-3-Clause
// Finds the colours of a map's landmarks in the images of its recording. Neither the bus nor the tracker has colours,
// so the images of keyframes are read once more when the map is complete.
#pragma once

#include <cstdint>

#include "camera_driver/source/image_source.h"
#include "map_server/atlas/atlas.h"
#include "map_server/outputs/colours.h"

namespace rumi::tool {

struct SeenColours {
  map_server::LandmarkColours colours;  // grey if the images are grey
  int64_t keyframes = 0;                // keyframes of the served map that see its landmarks
  int64_t seen = 0;                     // keyframes whose image the recording has
};

// Plays the images of keyframes again. A landmark of the served map gets the median colour of the pixels where a few
// keyframes saw it.
SeenColours landmark_colours(const map_server::Atlas& atlas, camera_driver::ImageSource& recording);

}  // namespace rumi::tool
