// SPDX-License-Identifier: BSD-3-Clause
// A config file with the options of every component or, if the input begins with '=', an argument of --set.
#include "fuzz/target.h"
#include "rumi/run/all_options.h"

namespace rumi::fuzz {
namespace {

// Making the table takes longer than most inputs, so it is made once.
class Options {
 public:
  Options() { describe(table_, options_); }
  OptionTable& at_defaults() {
    table_.reset();
    return table_;
  }

 private:
  tool::AllOptions options_;
  OptionTable table_;
};

OptionTable& fresh_table() {
  static Options options;
  return options.at_defaults();
}

void run(View input) {
  OptionTable& table = fresh_table();
  const std::string text = to_text(input);
  const std::string error = text.starts_with('=') ? table.set(text.substr(1)) : table.load_yaml_text(text, "input");
  if (error.empty() && !table.load_yaml_text(table.to_yaml(OptionTable::Which::kUsers), "again").empty())
    throw std::logic_error("options are not read back");
}

std::vector<Bytes> seeds() {
  return {to_bytes(fresh_table().to_yaml(OptionTable::Which::kUsers)),
          to_bytes(std::string("=map_server.snapshot_s=5")),
          to_bytes(
              std::string("front_tracker:\n  max_image_side: 640\nruminator: {spool: '', rebuild: no}\nother: [1]\n"))};
}

const Registered registered({"config", run, seeds});

}  // namespace
}  // namespace rumi::fuzz
