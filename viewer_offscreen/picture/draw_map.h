// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "viewer_offscreen/picture/map_view.h"
#include "viewer_offscreen/scene/scene.h"

namespace rumi::viewer_offscreen {

// Returns the picture of a map, 1280 x 720 BGR, as viewer_offscreen and `rumi replay` show it: with all views, or only
// one. Throws std::runtime_error if there is no OpenGL.
cv::Mat draw_map(const MapPicture& picture, std::optional<ViewKind> only = std::nullopt);

// `picture`: 8-bit BGR.
std::vector<uint8_t> encode_png(const cv::Mat& picture);
// Writes a PNG, and replaces an existing file in one step. Returns an Error with the file and the reason if that fails.
Result<> write_png(const cv::Mat& picture, const std::string& file);

}  // namespace rumi::viewer_offscreen
