// SPDX-License-Identifier: BSD-3-Clause
#include "base/this_process/account_limits.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <cerrno>
#include <cstring>
#include <optional>

namespace rumi {
namespace {

std::optional<double> limit_of(__rlimit_resource_t resource) {
  rlimit limit{};
  if (getrlimit(resource, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return std::nullopt;
  return static_cast<double>(limit.rlim_cur);
}

}  // namespace

std::string write_error_text(int error) {
  const std::string text = std::strerror(error);
  const std::optional<double> most = error == EFBIG ? limit_of(RLIMIT_FSIZE) : std::nullopt;
  return most ? fmt::format("{}: no file may have more than {:.1f} MB here (ulimit -f)", text, 1e-6 * *most) : text;
}

bool may_be_too_large() { return limit_of(RLIMIT_FSIZE).has_value(); }

std::string no_memory_text(const std::string& what) {
  const std::optional<double> most = limit_of(RLIMIT_AS);
  return most ? fmt::format("{}: a program may have {:.0f} MB here (ulimit -v)", what, 1e-6 * *most) : what;
}

std::string no_thread_text() {
  const std::optional<double> most = limit_of(RLIMIT_NPROC);
  const std::string what = "no further thread can be started";
  return most ? fmt::format("{}: a user may have {:.0f} processes and threads here (ulimit -u)", what, *most) : what;
}

}  // namespace rumi
