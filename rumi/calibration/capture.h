// SPDX-License-Identifier: BSD-3-Clause
// Collects views for a calibration from a recording or from the bus.
#pragma once

#include <functional>
#include <string>

#include "bus/transport/bus.h"
#include "rumi/calibration/view_collector.h"

namespace rumi::tool {

// Adds the images of a recording (any that camera_driver reads; it needs no calibration): every one, or every Nth if
// `every` is more than 1. Asks `go_on` after each image, and ends if it returns false. An Error if the recording cannot
// be read or an image does not fit the others.
Result<> collect_from_recording(const std::string& input, const std::string& log_channel, int every,
                                const std::function<bool()>& go_on, ViewCollector* collector);

// Adds the images on channels::kCamera whenever the bus is dispatched. Of the images that arrive while one is
// processed, only the latest is kept. The collector must outlive the bus.
void collect_from_bus(Bus& bus, ViewCollector* collector);

}  // namespace rumi::tool
