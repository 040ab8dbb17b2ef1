// SPDX-License-Identifier: BSD-3-Clause
#include "base/files/temporary_folder.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <system_error>

namespace rumi {

TemporaryFolder::TemporaryFolder(const std::filesystem::path& parent, const std::string& prefix)
    : path_((parent / (prefix + "XXXXXX")).string()) {
  if (!mkdtemp(path_.data()))
    throw std::runtime_error(fmt::format("{}: cannot be made: {}", path_, std::strerror(errno)));
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace rumi
