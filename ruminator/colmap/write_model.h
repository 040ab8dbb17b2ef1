// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "ruminator/colmap/colmap_database.h"
#include "ruminator/colmap/read_model.h"

namespace rumi::ruminator {

// Writes a model into an existing folder, in the format that `colmap mapper --input_path` reads (cameras.bin,
// images.bin, points3D.bin), with the images and the camera of write_colmap_database(). An Error has the file and the
// reason.
Result<> write_colmap_model(const std::string& folder, const Camera& camera, const std::vector<WindowImage>& images,
                            const SparseModel& model);

}  // namespace rumi::ruminator
