// SPDX-License-Identifier: BSD-3-Clause
// A robot's round on the ways of a campus. It comes back to its ways, crosses them, and goes some in both directions.
#pragma once

#include <cstdint>

#include "synth/camera_path.h"

namespace rumi::synth {

inline constexpr double kCampusSpeed_mps = 1.2;
inline constexpr double kMinCampusSeconds = 30, kMaxCampusSeconds = 3600;

// z is up. The camera looks ahead, and is as high as StreetField::kCameraHeight_m above a ground that is nearly flat.
CameraPath walk_campus(double seconds, uint64_t seed);

}  // namespace rumi::synth
