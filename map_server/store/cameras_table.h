// SPDX-License-Identifier: BSD-3-Clause
// map.db's table `cameras`: each calibration once.
#pragma once

#include <cstdint>

#include "base/files/sqlite.h"
#include "slam/geometry/camera.h"

namespace rumi::map_server {

// Returns the row of the calibration, and adds it if the table does not have it. Throws SqliteError.
int64_t camera_row(const Camera& camera, Database& database);
// Returns the calibration in this row. Throws SqliteError, or std::runtime_error if it does not exist or is invalid.
Camera read_camera(int64_t row, Database& database);

}  // namespace rumi::map_server
