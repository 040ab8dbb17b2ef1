// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "rumi/trajectory.h"

namespace rumi {

// The folder of a run as one web page: counts, views of the map, tracking over time, the error where the truth is
// given, windows with their images, joins with their reasons, load by process. Throws std::runtime_error with a message
// for the user if the folder is none of a finished run.
std::string make_report(const std::string& folder, const std::string& groundtruth = "", const TruthOptions& truth = {});

}  // namespace rumi
