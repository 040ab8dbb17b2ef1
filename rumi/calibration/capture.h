// SPDX-License-Identifier: BSD-3-Clause
// The sources of the images of a calibration.
#pragma once

#include <functional>
#include <string>

#include "bus/transport/bus.h"
#include "rumi/calibration/view_collector.h"

namespace rumi::tool {

// All images of a recording (whatever camera_driver reads; no calibration is needed), every Nth if `every` is more than
// 1. It ends when `go_on`, asked after each image, is false. An Error if the recording cannot be read or an image does
// not fit the others.
Result<> collect_from_recording(const std::string& input, const std::string& log_channel, int every,
                                const std::function<bool()>& go_on, ViewCollector* collector);

// The images on channels::kCamera from now on, as the bus is dispatched; of those that come while one is looked
// at only the latest is kept. The collector must outlive the bus.
void collect_from_bus(Bus& bus, ViewCollector* collector);

}  // namespace rumi::tool
