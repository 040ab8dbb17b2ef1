// SPDX-License-Identifier: BSD-3-Clause
// Where the images of a calibration come from.
#pragma once

#include <functional>
#include <string>

#include "bus/transport/bus.h"
#include "rumi/calibration/view_collector.h"

namespace rumi::tool {

// All images of a recording (whatever camera_driver reads; no calibration is needed), every Nth if `every` is more than
// 1. `go_on` is asked after each image. Returns what is wrong, or an empty string.
std::string collect_from_recording(const std::string& input, const std::string& log_channel, int every,
                                   const std::function<bool()>& go_on, ViewCollector* collector);

// The images on channels::kCamera from now on, as the bus is dispatched; what comes while one is looked at is dropped
// but for the latest. The collector must outlive the bus.
void collect_from_bus(Bus& bus, ViewCollector* collector);

}  // namespace rumi::tool
