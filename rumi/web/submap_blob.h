// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "viewer_offscreen/scene/scene.h"

namespace rumi::tool {

// The format that page/submap_blob.js reads, little endian. 8 uint32: a mark, the lengths of the four lists that
// follow, zeros. The path: first all times (float64, seconds since the epoch), then all positions (float32 x, y, z).
// For each keyframe float32 x, y, z of the camera and its map_from_cam rotation w, x, y, z. For each landmark float32
// x, y, z. For each two keyframes that see many landmarks in common, their indices (uint32).
inline constexpr char kSubmapBlobMark[4] = {'R', 'S', 'M', '1'};

std::string submap_blob(const viewer_offscreen::SubmapView& view);

}  // namespace rumi::tool
