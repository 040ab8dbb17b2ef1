// SPDX-License-Identifier: BSD-3-Clause
#include "bus/process.h"
#include "viewer_offscreen/viewer_node.h"

int main(int argc, char** argv) {
  rumi::ViewerOptions options;
  options.output = ".";
  rumi::ProcessDescription process;
  process.name = "viewer_offscreen";
  process.summary =
      "Draws the map as it grows, without a display: trajectory.png in a folder, and VIEWER_IMAGE. Follows RUMI_TRACK "
      "and "
      "RUMI_MAP_STATUS and fetches the submaps from map_server.";
  process.add_options = [&options](rumi::OptionTable& table) { rumi::describe(table, options); };
  process.make_node = [&options](rumi::Bus& bus) { return std::make_unique<rumi::ViewerNode>(bus, options); };
  return rumi::run_process(argc, argv, process);
}
