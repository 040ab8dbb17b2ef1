// SPDX-License-Identifier: BSD-3-Clause
// Where the camera is on the body whose path an EuRoC or TUM-VI dataset has as its truth.
#pragma once

#include <filesystem>
#include <optional>

#include "slam/geometry/transform.h"

namespace rumi {

struct TrackedFrame {
  std::filesystem::path asked;          // the file that should say it
  bool is_in_dataset = false;           // that file, or a camchain, is there
  std::optional<SE3> tracked_from_cam;  // nothing: they do not say
};

// For .../mav0/NAME/data.csv: T_BS of ../cam0/sensor.yaml, or T_cam_imu of a camchain.yaml; and T_BS of
// NAME/sensor.yaml if what is tracked is not the body itself (EuRoC's vicon0).
TrackedFrame read_tracked_frame(const std::filesystem::path& truth);

}  // namespace rumi
