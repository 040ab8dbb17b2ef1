// SPDX-License-Identifier: BSD-3-Clause
// Every option of every component in one place. A replay runs with them, `rumi up` checks them before it starts
// anything, and config/rumi.yaml is made from them.
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

// Options of `rumi up` itself.
struct UpOptions {
  std::string input;               // recording or camera for camera_driver; empty: the images come from elsewhere
  std::string lcm_url;             // empty: LCM_DEFAULT_URL if it is set, else the built-in one
  std::string channel_prefix;      // put before the name of every channel
  std::string channel = "CAMERA";  // name of the channel of the images
  bool viewer = true;
  double settle_s = 2.0;  // from the end of the input to the stop of the other processes
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
