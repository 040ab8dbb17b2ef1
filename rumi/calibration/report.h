// SPDX-License-Identifier: BSD-3-Clause
// A calibration in words: for a person, and as the file.
#pragma once

#include <string>

#include "rumi/calibration/calibrator.h"
#include "rumi/calibration/view_collector.h"

namespace rumi::tool {

// Why no view was taken. Precondition: none was.
std::string why_no_views(const ViewCollector& collector, const std::string& source);

// Several lines for a person.
std::string describe(const Calibration& calibration);

// Our YAML, with comments on how the calibration was made.
std::string calibration_to_yaml(const Calibration& calibration, const ViewCollector& collector);

}  // namespace rumi::tool
