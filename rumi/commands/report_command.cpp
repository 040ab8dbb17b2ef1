// SPDX-License-Identifier: BSD-3-Clause
// rumi report OUT: writes a run as one web page.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "base/files/whole_file.h"
#include "rumi/commands/command_frame.h"
#include "rumi/commands/commands.h"
#include "rumi/report/run_report.h"

namespace rumi::tool {
namespace {

struct Arguments {
  std::string out, file;
  ReportOptions options;
};

void report(const Arguments& arguments) {
  const std::string file =
      arguments.file.empty() ? (std::filesystem::path(arguments.out) / "report.html").string() : arguments.file;
  const std::string page = make_report(arguments.out, arguments.options);
  WholeFile output(file);
  output.write(page);
  if (const Result<> written = output.commit(); !written)
    fail_if(written.error_text() + "; -o FILE puts the page elsewhere");
  fmt::print("report  {}\n", file);
}

}  // namespace

void add_report_command(CommandLine& app, std::function<int()>* chosen) {
  auto arguments = std::make_shared<Arguments>();
  CommandLine* command = app.add_command("report", "Make one web page of a run, which opens from disk");
  command->add_option("OUT", arguments->out, "output folder of `rumi replay` or `rumi snapshot`")->required();
  command->add_option("-o,--output", arguments->file, "the page; default: OUT/report.html")->type_name("FILE");
  command->add_option("--groundtruth", arguments->options.groundtruth, "true path, for errors; see `rumi evaluate`")
      ->type_name("FILE");
  command
      ->add_option("--groundtruth-rate", arguments->options.truth.frames_per_second,
                   "the truth counts images at this rate, Hz, see `rumi evaluate`; 0: it has times")
      ->not_negative()
      ->show_default();
  command->add_option("--log", arguments->options.log, "lcm log of a live run, for the load of its processes over time")
      ->type_name("FILE");
  run_if_chosen(command, chosen, arguments, report);
}

}  // namespace rumi::tool
