// SPDX-License-Identifier: BSD-3-Clause
// The served map as a COLMAP sparse model: its keyframes are the images, its landmarks the 3D points. Every image and
// every point is there once, as join() makes them one (see map_model.h): an image that several submaps have a keyframe
// of has the pose and the keypoints of one of them, the back submap's if there is one, and the observations of all.
//
// COLMAP's upper-left pixel centre is (0.5, 0.5): keypoints and principal points get +0.5. Images are named as
// ImageFiles says, else <seconds>.<microseconds>.jpg of their capture. Lenses: pinhole becomes OPENCV, with k3
// FULL_OPENCV, fisheye OPENCV_FISHEYE. Landmarks seen by fewer than two keyframes of the map are left out: COLMAP has
// no such points.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "base/result.h"
#include "map_server/atlas/atlas.h"
#include "map_server/outputs/colours.h"

namespace rumi::map_server {

// An image's file by the name that COLMAP shall know it by, and its size: keypoints and camera are given in its pixels.
struct ImageFile {
  std::string name;
  int width = 0, height = 0;
};
using ImageFiles = std::map<ImageId, ImageFile>;

// Returns the images of the model.
std::vector<ImageId> colmap_images(const Atlas& atlas);
// Returns the name that one of `images` has in the model if no ImageFile names it.
std::string colmap_name(const ImageId& image, const std::vector<ImageId>& images);

// Writes cameras, images and points3D into the folder (created), as .txt or .bin. An Error names the file that cannot
// be written, or a name of an image that the format cannot hold.
Result<> write_colmap_text(const Atlas& atlas, const std::string& folder, const LandmarkColours& colours = {},
                           const ImageFiles& files = {});
Result<> write_colmap_binary(const Atlas& atlas, const std::string& folder, const LandmarkColours& colours = {},
                             const ImageFiles& files = {});

}  // namespace rumi::map_server
