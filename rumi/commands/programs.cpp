// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/commands/programs.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "rumi/run/program_folder.h"

namespace rumi::tool {

Result<> become_program(char** argv) {
  const std::string name = argv[0] && argv[1] ? argv[1] : "";
  if (std::find(kPrograms.begin(), kPrograms.end(), name) == kPrograms.end()) return {};
  std::string program = (program_folder_of(own_folder()) / name).string();
  argv[1] = program.data();
  execv(program.c_str(), argv + 1);
  return Error{fmt::format("cannot be started: {}", std::strerror(errno)), program, "install Rumi again, or build it"};
}

}  // namespace rumi::tool
