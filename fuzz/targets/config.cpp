// SPDX-License-Identifier: BSD-3-Clause
// A config file with the options of every component, or, where it begins with '=', a --set.
#include "fuzz/target.h"
#include "rumi/run/all_options.h"

namespace rumi::fuzz {
namespace {

void run(View input) {
  tool::AllOptions options;
  OptionTable table;
  describe(table, options);
  const std::string text = to_text(input);
  const std::string error = text.starts_with('=') ? table.set(text.substr(1)) : table.load_yaml_text(text, "input");
  if (error.empty() && !table.load_yaml_text(table.to_yaml(OptionTable::Which::kAll), "again").empty())
    throw std::logic_error("options are not read back");
}

std::vector<Bytes> seeds() {
  tool::AllOptions options;
  OptionTable table;
  describe(table, options);
  return {to_bytes(table.to_yaml(OptionTable::Which::kUsers)), to_bytes(std::string("=map_server.snapshot_s=5")),
          to_bytes(
              std::string("front_tracker:\n  max_image_side: 640\nruminator: {spool: '', rebuild: no}\nother: [1]\n"))};
}

const Registered registered({"config", run, seeds});

}  // namespace
}  // namespace rumi::fuzz
