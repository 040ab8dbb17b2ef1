// SPDX-License-Identifier: BSD-3-Clause
// A calibration as text for a person, and as a file.
#pragma once

#include <string>

#include "rumi/calibration/calibrator.h"
#include "rumi/calibration/view_collector.h"

namespace rumi::tool {

// Says why no view was taken. Precondition: collector.taken() is empty.
std::string why_no_views(const ViewCollector& collector, const std::string& source);

// Returns the parameters, errors and outliers for a person, in several lines.
std::string describe(const Calibration& calibration);

// Returns our YAML, with comments on how the calibration was made.
std::string calibration_to_yaml(const Calibration& calibration, const ViewCollector& collector);

}  // namespace rumi::tool
