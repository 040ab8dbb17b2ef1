// SPDX-License-Identifier: BSD-3-Clause
// Reads the sparse models that COLMAP's mapper leaves (cameras.bin, images.bin, points3D.bin).
#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "ruminator/model/sparse_model.h"

namespace rumi::ruminator {

// Checks every count, index and number in the files: images and keypoints as in `keypoint_counts` (per image), finite
// values, positive focal lengths. A missing, truncated or corrupt file is an Error with its name, what is wrong and the
// byte.
Result<SparseModel> read_colmap_model(const std::string& folder, const std::vector<int>& keypoint_counts);
// The folders 0, 1, 2, ... that the mapper made under `folder`, in order.
std::vector<std::string> colmap_model_folders(const std::string& folder);

}  // namespace rumi::ruminator
