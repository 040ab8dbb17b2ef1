// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "base/command_line/options.h"
#include "bus/wire/working_image.h"
#include "front_tracker/tracking/tracker_options.h"

namespace rumi::front_tracker {

struct FrontTrackerOptions : TrackerOptions {
  double publish_interval_s = 0.5;            // time between two updates of a submap, at least
  int max_image_side = kDefaultMaxImageSide;  // pixels; larger images are made smaller first
  std::string camera_file;                    // calibration file that replaces the calibration sent with the images;
                                              // empty: none
};

void describe(OptionTable& table, FrontTrackerOptions& options);

}  // namespace rumi::front_tracker
