// SPDX-License-Identifier: BSD-3-Clause
#include "base/command_line/about.h"
#include "bus/process/process.h"
#include "viewer_offscreen/viewer_node.h"

int main(int argc, char** argv) {
  rumi::viewer_offscreen::ViewerOptions options;
  options.output = ".";
  rumi::ProcessDescription process;
  process.name = "viewer_offscreen";
  process.about = rumi::about(process.name);
  process.summary =
      "Draws the map as it grows, without a display: trajectory.png in a folder, and VIEWER_IMAGE. Follows RUMI_TRACK "
      "and "
      "RUMI_MAP_STATUS and fetches the submaps from map_server.";
  process.add_options = [&options](rumi::OptionTable& table) { describe(table, options); };
  process.make_node = [&options](rumi::Bus& bus) {
    return std::make_unique<rumi::viewer_offscreen::ViewerNode>(bus, options);
  };
  return rumi::run_process(argc, argv, process);
}
