// SPDX-License-Identifier: BSD-3-Clause
// The served map as a COLMAP sparse model: its keyframes are the images, its landmarks the 3D points. Every image and
// every point is there once, as join() makes them one (see map_model.h): an image that several submaps have a keyframe
// of has the pose and the keypoints of one of them, the back submap's if there is one, and the observations of all.
//
// COLMAP's upper-left pixel centre is (0.5, 0.5): keypoints and principal points get +0.5. Images are named
// <seconds>.<microseconds>.jpg of their capture. Lenses: pinhole becomes OPENCV, with k3 FULL_OPENCV, fisheye
// OPENCV_FISHEYE. Landmarks seen by fewer than two keyframes of the map are left out: COLMAP has no such points.
#pragma once

#include <string>

#include "map_server/atlas/atlas.h"
#include "map_server/outputs/writers.h"

namespace rumi::map_server {

// Writes cameras, images and points3D into the folder (created), as .txt or .bin. An empty string, or the file and why
// not.
std::string write_colmap_text(const Atlas& atlas, const std::string& folder, const LandmarkColours& colours = {});
std::string write_colmap_binary(const Atlas& atlas, const std::string& folder, const LandmarkColours& colours = {});

}  // namespace rumi::map_server
