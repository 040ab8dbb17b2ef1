// SPDX-License-Identifier: BSD-3-Clause
// Finds the images of a COLMAP model for other programs.
#pragma once

#include <cstdint>
#include <string>

#include "camera_driver/source/image_source.h"
#include "map_server/outputs/colmap_export.h"

namespace rumi::tool {

struct ColmapImages {
  map_server::ImageFiles files;  // files of those images that the recording has
  std::string folder;            // names of files are relative to it: COLMAP's --image_path
  int64_t keyframes = 0;         // number of keyframes in the served map
  bool are_written = false;      // the recording has no image files, so files were written
};

// Plays the keyframes of the served map again. If the recording has image files, they are named relative to the deepest
// folder that contains all of its images. Otherwise (video, log, bag) each image is written to FOLDER/images/TIME.jpg.
// Throws std::runtime_error if an image cannot be written.
ColmapImages find_colmap_images(const map_server::Atlas& atlas, camera_driver::ImageSource& recording,
                                const std::string& folder);

}  // namespace rumi::tool
