// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/run/all_options.h"

namespace rumi::tool {

void describe(OptionTable& table, UpOptions& o) {
  table.add(
      "up.input", &o.input,
      "of camera_driver: camera, dataset, image folder, video, lcm log or ROS bag; empty: images come from elsewhere");
  table.add("up.lcm_url", &o.lcm_url, "LCM URL; empty: LCM_DEFAULT_URL, else this machine only");
  table.add("up.channel_prefix", &o.channel_prefix, "put before every channel name");
  table.add("up.channel", &o.channel, "channel of the camera images");
  table.add("up.viewer", &o.viewer, "start viewer_offscreen too");
  table.add("up.settle_s", &o.settle_s, "s", "from the end of the input to the stop of the others", 0, 3600);
  table.for_users({"up.input", "up.lcm_url", "up.channel_prefix", "up.channel", "up.viewer", "up.settle_s"});
}

void describe(OptionTable& table, AllOptions& o) {
  describe(table, o.up);
  describe(table, o.camera_driver);
  describe(table, o.front_tracker);
  describe(table, o.ruminator);
  describe(table, o.map_server);
  describe(table, o.viewer_offscreen);
}

}  // namespace rumi::tool
