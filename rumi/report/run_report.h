// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "formats/truth/truth.h"

namespace rumi::tool {

struct ReportOptions {
  std::string groundtruth = {};  // file of the true path; empty: the page shows no errors
  TruthOptions truth = {};
  std::string log = {};  // lcm log with RUMI_STATUS of a live run; empty: the page shows no load over time
};

// Returns one web page on the run in `folder`: counts, views of the map, tracking over time, the error if a truth is
// given, windows with their images, masks, joins with their reasons, matched features over time, and load by process. A
// run whose map.db could not be written (run.json says so) gets a shorter page. Throws std::runtime_error, with a
// message for the user, if the folder does not hold a finished run.
std::string make_report(const std::string& folder, const ReportOptions& options = {});

}  // namespace rumi::tool
