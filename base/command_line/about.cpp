// SPDX-License-Identifier: BSD-3-Clause
#include "base/command_line/about.h"

#include <fmt/format.h>

#include "base/this_process/process_name.h"

namespace rumi {

std::string about(const std::string& program) { return fmt::format("{} {}\ncommit {}", program, version(), kCommit); }

}  // namespace rumi
