// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/commands/up_processes.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "base/files/scratch_folder.h"
#include "camera_driver/open_source.h"
#include "rumi/run/program_folder.h"

namespace rumi::tool {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> bus_flags(const UpOptions& up) {
  std::vector<std::string> flags;
  if (!up.lcm_url.empty()) flags.insert(flags.end(), {"--lcm-url", up.lcm_url});
  if (!up.channel_prefix.empty()) flags.insert(flags.end(), {"--channel-prefix", up.channel_prefix});
  flags.insert(flags.end(), {"--channel", up.channel});
  return flags;
}

}  // namespace

SharedConfig::SharedConfig(const std::string& yaml) {
  std::string name = (fs::path(scratch_folder()) / "rumi-up-XXXXXX").string();
  const int fd = mkstemp(name.data());
  if (fd < 0) throw std::runtime_error(fmt::format("{}: cannot be made: {}", name, std::strerror(errno)));
  file_ = name;
  close(fd);
  write(yaml);
}

SharedConfig::~SharedConfig() { unlink(file_.c_str()); }

void SharedConfig::write(const std::string& yaml) const {
  std::ofstream stream(file_);
  if (!(stream << yaml << std::flush)) throw std::runtime_error(fmt::format("{}: cannot be written", file_));
}

std::vector<Supervised> processes(const UpOptions& up, const std::string& config_file, const UpArguments& arguments) {
  const fs::path folder = program_folder_of(own_folder());
  std::vector<Supervised> children;
  using Words = std::vector<std::string>;
  const auto add = [&](const std::string& name, int stop_stage, const Words& more = {}) {
    Supervised child{name, {(folder / name).string()}, false, stop_stage};
    child.command.insert(child.command.end(), more.begin(), more.end());
    child.command.insert(child.command.end(), {"--config", config_file});
    for (const std::string& flag : bus_flags(up)) child.command.push_back(flag);
    if (arguments.verbose) child.command.push_back("--verbose");
    if (arguments.quiet) child.command.push_back("--quiet");
    children.push_back(std::move(child));
  };
  // Processes that listen are started first, the source of images last.
  const std::string& calibration = arguments.calibration;
  add("map_server", 1);
  add("ruminator", 0, calibration.empty() ? Words() : Words{"--set", "ruminator.camera_file=" + calibration});
  children.back().finishes = true;
  if (up.viewer) add("viewer_offscreen", 0);
  add("front_tracker", 0, calibration.empty() ? Words() : Words{"--camera", calibration});
  if (!up.input.empty()) {
    add("camera_driver", 0, {up.input});
    children.back().source = true;
    children.back().reloads = true;
    children.back().fails_once =
        !camera_driver::is_camera(up.input);  // a camera may be plugged in again, so it is restarted
  }
  return children;
}

Supervised snapshot_process(const AllOptions& options, const std::string& config_file, const std::string& out,
                            int64_t since_us, bool is_last) {
  const UpOptions& up = options.up;
  std::vector<std::string> command{(own_folder() / "rumi").string(), "snapshot", "-o", out};
  command.insert(command.end(), {"--since", std::to_string(since_us), is_last ? "--update" : "--quiet"});
  if (!up.lcm_url.empty()) command.insert(command.end(), {"--lcm-url", up.lcm_url});
  if (!up.channel_prefix.empty()) command.insert(command.end(), {"--channel-prefix", up.channel_prefix});
  const bool has_its_times = !options.camera_driver.loop && !options.camera_driver.live_stamps;
  if (is_last && has_its_times && !up.input.empty() && !camera_driver::is_camera(up.input))
    command.insert(command.end(), {"--images", up.input, "--config", config_file});
  return {"snapshot", command};
}

}  // namespace rumi::tool
