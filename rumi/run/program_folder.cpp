// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/run/program_folder.h"

namespace rumi::tool {

namespace fs = std::filesystem;

fs::path program_folder_of(const fs::path& bin) {
  std::error_code error;
  const fs::path installed = (bin / RUMI_PROGRAMS_FROM_BIN).lexically_normal();
  return fs::is_directory(installed, error) ? installed : bin;
}

fs::path own_folder() { return fs::read_symlink("/proc/self/exe").parent_path(); }

}  // namespace rumi::tool
