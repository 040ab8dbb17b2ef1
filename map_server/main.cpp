// SPDX-License-Identifier: BSD-3-Clause
#include "base/command_line/about.h"
#include "bus/process/process.h"
#include "map_server/map_server_node.h"

int main(int argc, char** argv) {
  rumi::map_server::MapServerOptions options;
  rumi::ProcessDescription process;
  process.name = "map_server";
  process.about = rumi::about(process.name);
  process.only_one = true;
  process.summary =
      "Keeps all submaps in one database (map.db), serves the map and its state to whoever asks. Submaps come in on "
      "RUMI_SUBMAP, the state goes out on RUMI_MAP_STATUS, what RUMI_MAP_REQUEST asks for on RUMI_MAP_CHUNK.";
  process.add_options = [&options](rumi::OptionTable& table) { describe(table, options); };
  process.make_node = [&options](rumi::Bus& bus) {
    return std::make_unique<rumi::map_server::MapServerNode>(bus, options);
  };
  return rumi::run_process(argc, argv, process);
}
