// SPDX-License-Identifier: BSD-3-Clause
#include "base/command_line/about.h"
#include "bus/process/process.h"
#include "formats/camera/given_camera.h"
#include "ruminator/colmap_builder.h"
#include "ruminator/ruminator_node.h"

int main(int argc, char** argv) {
  rumi::ruminator::RuminatorOptions options;
  rumi::ProcessDescription process;
  process.name = "ruminator";
  process.about = rumi::about(process.name);
  process.only_one = true;
  process.summary =
      "Rebuilds with COLMAP what was not tracked: keeps the images around every loss (CAMERA, RUMI_TRACK), makes a "
      "back "
      "submap of them, sends it to map_server (RUMI_SUBMAP), and says on RUMI_WINDOW how far it is. SIGINT and SIGTERM "
      "end it at once and leave what is not done in the spool; SIGUSR1 ends it when all is done.";
  process.add_options = [&options](rumi::OptionTable& table) { describe(table, options); };
  process.make_node = [&options](rumi::Bus& bus) {
    rumi::ruminator::RuminatorHooks hooks;
    if (options.rebuild) hooks.use(rumi::ruminator::colmap_builder(options.build));
    return std::make_unique<rumi::ruminator::RuminatorNode>(bus, options, std::move(hooks),
                                                            rumi::read_given_camera(options.camera_file));
  };
  return rumi::run_process(argc, argv, process);
}
