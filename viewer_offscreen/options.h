// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "bus/options.h"

namespace rumi {

struct ViewerOptions {
  std::string output;     // folder for trajectory.png; empty: only VIEWER_IMAGE
  double interval_s = 5;  // between pictures
  int jpeg_quality = 90;  // of VIEWER_IMAGE
};

inline void describe(OptionTable& table, ViewerOptions& o) {
  table.add("viewer_offscreen.output", &o.output, "folder that trajectory.png is written into; empty: no file");
  table.add("viewer_offscreen.interval_s", &o.interval_s, "s", "from one picture to the next", 0.1, 86400);
  table.add("viewer_offscreen.jpeg_quality", &o.jpeg_quality, "", "of VIEWER_IMAGE", 1, 100);
}

}  // namespace rumi
