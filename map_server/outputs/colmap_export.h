// SPDX-License-Identifier: BSD-3-Clause
// Writes the served map as a COLMAP sparse model: its keyframes are the images, its landmarks the 3D points. Each image
// and each point appears once (see join() in map_model.h): if several submaps have a keyframe of an image, the image
// has the pose and keypoints of one of them (of a back submap, if there is one), and the observations of all.
//
// COLMAP's upper-left pixel centre is (0.5, 0.5), so 0.5 is added to keypoints and principal points. Images have the
// names given by ImageFiles, or else <seconds>.<microseconds>.jpg of their capture. The camera models are OPENCV for
// pinhole, FULL_OPENCV for pinhole with k3, and OPENCV_FISHEYE for fisheye. Landmarks seen by fewer than two keyframes
// of the map are left out, because COLMAP allows no such points.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "base/result.h"
#include "map_server/atlas/atlas.h"
#include "map_server/outputs/colours.h"

namespace rumi::map_server {

// The name of an image in COLMAP, and the size of its file: keypoints and camera are given in the pixels of the file.
struct ImageFile {
  std::string name;
  int width = 0, height = 0;
};
using ImageFiles = std::map<ImageId, ImageFile>;

// Returns the images of the model.
std::vector<ImageId> colmap_images(const Atlas& atlas);
// Returns the name of one of `images` in the model if no ImageFile gives it one.
std::string colmap_name(const ImageId& image, const std::vector<ImageId>& images);

// Writes cameras, images and points3D into the folder (creating it), as .txt or .bin. An Error names the file that
// cannot be written, or an image name that the format cannot express.
Result<> write_colmap_text(const Atlas& atlas, const std::string& folder, const LandmarkColours& colours = {},
                           const ImageFiles& files = {});
Result<> write_colmap_binary(const Atlas& atlas, const std::string& folder, const LandmarkColours& colours = {},
                             const ImageFiles& files = {});

}  // namespace rumi::map_server
