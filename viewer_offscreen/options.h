// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "base/command_line/options.h"

namespace rumi::viewer_offscreen {

struct ViewerOptions {
  std::string output;      // folder for trajectory.png and the series; empty: only VIEWER_IMAGE
  double interval_s = 20;  // time between two pictures
  bool camera = true;      // show the camera's image
  bool series = false;     // keep every picture
  // Whether a series that was not ended (its process died) goes on after a new start. Replay sets it to false.
  bool series_goes_on = true;
};

inline void describe(OptionTable& table, ViewerOptions& o) {
  table.group("viewer_offscreen");
  table.add("viewer_offscreen.output", &o.output, "folder that trajectory.png is written into; empty: no file");
  table.add("viewer_offscreen.interval_s", &o.interval_s, "s", "from one picture to the next", 0.1, 86400);
  table.add("viewer_offscreen.camera", &o.camera, "show the camera's image with the keypoints of the latest keyframe");
  table.add(
      "viewer_offscreen.series", &o.series,
      "keep every picture: pictures/000001.png, ... in the folder, and trajectory.mp4; a series that was not ended "
      "goes on, else it begins anew");
  table.for_users(
      {"viewer_offscreen.output", "viewer_offscreen.interval_s", "viewer_offscreen.camera", "viewer_offscreen.series"});
}

}  // namespace rumi::viewer_offscreen
