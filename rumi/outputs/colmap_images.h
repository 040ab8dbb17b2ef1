// SPDX-License-Identifier: BSD-3-Clause
// Finds the images of a COLMAP model for other programs.
#pragma once

#include <cstdint>
#include <string>

#include "camera_driver/source/image_source.h"
#include "map_server/outputs/colmap_export.h"

namespace rumi::tool {

struct ColmapImages {
  map_server::ImageFiles files;  // images that the recording has
  std::string folder;            // names are relative to it: COLMAP's --image_path
  int64_t keyframes = 0;         // in the served map
  bool are_written = false;      // the recording has no files, so files were made
};

// Plays the keyframes of the served map again. If the recording has files, these are named, relative to the deepest
// folder that has all of its images. For a video, a log or a bag each image is written as FOLDER/images/TIME.jpg.
// Throws std::runtime_error if one cannot be written.
ColmapImages find_colmap_images(const map_server::Atlas& atlas, camera_driver::ImageSource& recording,
                                const std::string& folder);

}  // namespace rumi::tool
