// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "camera_driver/recording/frame_order.h"

namespace rumi::camera_driver {

struct MissingImages {
  int64_t count = 0;
  int64_t period_us = 0;  // from an image to the next
};

// Those that a recorder has lost, as far as the times show it: of images that come at one rate, the steps from one to
// the next are then whole periods. None where the steps are of any length, as where only changes were recorded, and of
// a pause: a step of more than ten periods.
MissingImages find_missing_images(const std::vector<OrderedFrame>& frames);

}  // namespace rumi::camera_driver
