// SPDX-License-Identifier: BSD-3-Clause
// Finds where the camera is on the body whose path is the truth of an EuRoC or TUM-VI dataset.
#pragma once

#include <filesystem>
#include <optional>

#include "slam/geometry/transform.h"

namespace rumi {

struct TrackedFrame {
  std::filesystem::path asked;          // the file that should say where the camera is
  bool is_in_dataset = false;           // that file, or a camchain.yaml, is there
  std::optional<SE3> tracked_from_cam;  // nullopt: the files do not say
};

// For .../mav0/NAME/data.csv: combines T_BS of ../cam0/sensor.yaml, or T_cam_imu of a camchain.yaml, with T_BS of
// NAME/sensor.yaml if another point than the body itself is tracked (EuRoC's vicon0).
TrackedFrame read_tracked_frame(const std::filesystem::path& truth);

}  // namespace rumi
