// SPDX-License-Identifier: BSD-3-Clause
#include "bus/log.h"

#include <spdlog/spdlog.h>

namespace rumi {
namespace {

spdlog::level::level_enum spdlog_level(LogLevel level) {
  switch (level) {
    case LogLevel::kDebug:
      return spdlog::level::debug;
    case LogLevel::kInfo:
      return spdlog::level::info;
    case LogLevel::kWarning:
      return spdlog::level::warn;
    case LogLevel::kError:
      return spdlog::level::err;
  }
  return spdlog::level::err;
}

}  // namespace

void log_line(LogLevel level, const std::string& text) { spdlog::log(spdlog_level(level), "{}", text); }
bool is_logged(LogLevel level) { return spdlog::should_log(spdlog_level(level)); }

}  // namespace rumi
