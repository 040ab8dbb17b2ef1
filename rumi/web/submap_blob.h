// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "viewer_offscreen/scene/scene.h"

namespace rumi::tool {

// The format that page/submap_blob.js reads, little endian: 8 uint32 (a mark, the lengths of the lists that follow,
// zeros); for each pose of the path float64 seconds since the epoch and float32 x, y, z; for each keyframe float32 x,
// y, z of the camera and its map_from_cam rotation w, x, y, z; for each landmark float32 x, y, z; for each two
// keyframes that see many landmarks in common a uint32 pair of their numbers.
inline constexpr char kSubmapBlobMark[4] = {'R', 'S', 'M', '1'};

std::string submap_blob(const viewer_offscreen::SubmapView& view);

}  // namespace rumi::tool
