// SPDX-License-Identifier: BSD-3-Clause
// map.db's table `cameras`: calibrations, each of them once.
#pragma once

#include <cstdint>

#include "base/files/sqlite.h"
#include "slam/geometry/camera.h"

namespace rumi::map_server {

// The row of the calibration, which is added if the table does not have it. Throws SqliteError.
int64_t camera_row(const Camera& camera, Database& database);
// Throws SqliteError, or std::runtime_error if there is no such row or its calibration makes no sense.
Camera read_camera(int64_t row, Database& database);

}  // namespace rumi::map_server
