// SPDX-License-Identifier: BSD-3-Clause
#include "base/this_process/process_name.h"

#include <fmt/format.h>
#include <unistd.h>

namespace rumi {

const char* version() { return RUMI_VERSION; }

std::string host_name() {
  char name[256] = "";
  gethostname(name, sizeof(name) - 1);
  return name;
}

std::string unique_process_name(const std::string& process_name) {
  return fmt::format("{}@{}:{}", process_name, host_name(), getpid());
}

}  // namespace rumi
