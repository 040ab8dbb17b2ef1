// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "camera_driver/recording/frame_order.h"

namespace rumi::camera_driver {

struct MissingImages {
  int64_t count = 0;
  int64_t period_us = 0;  // median time from an image to the next
};

// Counts the images that a recorder has lost, as far as the times show it: if images come at one rate, the steps from
// one to the next are whole periods. Counts none if the steps have any length (a camera that records only changes), and
// none in a pause of more than ten periods.
MissingImages find_missing_images(const std::vector<OrderedFrame>& frames);

}  // namespace rumi::camera_driver
