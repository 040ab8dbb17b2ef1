// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/run/program_folder.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace rumi::tool {

namespace fs = std::filesystem;

fs::path program_folder_of(const fs::path& bin) {
  std::error_code error;
  const fs::path installed = (bin / RUMI_PROGRAMS_FROM_BIN).lexically_normal();
  return fs::is_directory(installed, error) ? installed : bin;
}

fs::path own_folder() { return fs::read_symlink("/proc/self/exe").parent_path(); }

std::string become_program(char** argv) {
  const std::string name = argv[0] && argv[1] ? argv[1] : "";
  if (std::find(kPrograms.begin(), kPrograms.end(), name) == kPrograms.end()) return {};
  std::string program = (program_folder_of(own_folder()) / name).string();
  argv[1] = program.data();
  execv(program.c_str(), argv + 1);
  return fmt::format("{}: cannot be started: {}; install Rumi again, or build it", program, std::strerror(errno));
}

}  // namespace rumi::tool
