// SPDX-License-Identifier: BSD-3-Clause
// Every option of every component in one place: replay takes them, `rumi up` checks them before it starts anything, and
// config/rumi.yaml is made from them.
#pragma once

#include <string>
#include <vector>

#include "base/command_line/options.h"
#include "camera_driver/options.h"
#include "front_tracker/options.h"
#include "map_server/options.h"
#include "ruminator/options.h"
#include "viewer_offscreen/options.h"

namespace rumi::tool {

// Options of `rumi up` alone.
struct UpOptions {
  std::string input;               // input of camera_driver; empty: the images come from elsewhere
  std::string lcm_url;             // empty: LCM_DEFAULT_URL, else the built-in one
  std::string channel_prefix;      // before every channel name
  std::string channel = "CAMERA";  // channel of the images
  bool viewer = true;
  double settle_s = 2.0;  // from the end of the input to the stop of the others
};

struct AllOptions {
  UpOptions up;
  camera_driver::CameraOptions camera_driver;
  front_tracker::FrontTrackerOptions front_tracker;
  ruminator::RuminatorOptions ruminator;
  map_server::MapServerOptions map_server;
  viewer_offscreen::ViewerOptions viewer_offscreen;
};

void describe(OptionTable& table, UpOptions& options);
void describe(OptionTable& table, AllOptions& options);

}  // namespace rumi::tool
