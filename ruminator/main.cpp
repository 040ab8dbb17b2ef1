// SPDX-License-Identifier: BSD-3-Clause
#include "bus/process.h"
#include "ruminator/ruminator_node.h"

int main(int argc, char** argv) {
  rumi::RuminatorOptions options;
  rumi::ProcessDescription process;
  process.name = "ruminator";
  process.summary =
      "Follows the tracking state and keeps the images around every loss. Announces its windows on RUMI_WINDOW; frames "
      "come "
      "in on CAMERA, what became of them on RUMI_TRACK.";
  process.add_options = [&options](rumi::OptionTable& table) { rumi::describe(table, options); };
  process.make_node = [&options](rumi::Bus& bus) { return std::make_unique<rumi::RuminatorNode>(bus, options); };
  return rumi::run_process(argc, argv, process);
}
