// SPDX-License-Identifier: BSD-3-Clause
// Reads the sparse models that COLMAP's mapper writes (cameras.bin, images.bin, points3D.bin).
#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "ruminator/model/sparse_model.h"

namespace rumi::ruminator {

// Checks every count, index and number in the files: images and keypoints must agree with `keypoint_counts` (by image),
// values must be finite and focal lengths positive. If a file is missing, truncated or corrupt, returns an Error with
// its name, the fault and the position in bytes.
Result<SparseModel> read_colmap_model(const std::string& folder, const std::vector<int>& keypoint_counts);
// Returns the folders 0, 1, 2, ... that the mapper made in `folder`, in order.
std::vector<std::string> colmap_model_folders(const std::string& folder);

}  // namespace rumi::ruminator
