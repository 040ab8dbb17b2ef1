// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "viewer_offscreen/scene/scene.h"

namespace rumi::tool {

// What page/submap_blob.js reads, little endian: 8 uint32 (a mark, how many of each of the following, zeros); of the
// path float64 seconds since the epoch and float32 x, y, z; of the keyframes float32 x, y, z of the camera and its
// map_from_cam rotation w, x, y, z; of the landmarks float32 x, y, z; of keyframes that see many landmarks in common
// uint32 pairs of their numbers.
inline constexpr char kSubmapBlobMark[4] = {'R', 'S', 'M', '1'};

std::string submap_blob(const viewer_offscreen::SubmapView& view);

}  // namespace rumi::tool
