// SPDX-License-Identifier: BSD-3-Clause
// What is said of a calibration: to a person, and in the file.
#pragma once

#include <string>

#include "rumi/calibration/calibrator.h"
#include "rumi/calibration/view_collector.h"

namespace rumi::tool {

// Why no calibration can be made where no view was taken; precondition: none was.
std::string why_no_views(const ViewCollector& collector, const std::string& source);

// Several lines for a person. Precondition: calibration.ok().
std::string describe(const Calibration& calibration);

// Our YAML, with how it was made as comments. Precondition: calibration.ok().
std::string calibration_to_yaml(const Calibration& calibration, const ViewCollector& collector);

}  // namespace rumi::tool
