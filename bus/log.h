// SPDX-License-Identifier: BSD-3-Clause
// Lines for a person, to stderr with the time and the process's name; start_logging() in process.h says from which
// level on. spdlog does it; only log.cpp includes its headers, which bring the whole of fmt into every file.
#pragma once

#include <fmt/format.h>

#include <string>
#include <utility>

namespace rumi {

enum class LogLevel { kDebug, kInfo, kWarning, kError };

void log_line(LogLevel level, const std::string& text);
bool is_logged(LogLevel level);

template <class... Args>
void log_debug(fmt::format_string<Args...> format, Args&&... args) {
  if (is_logged(LogLevel::kDebug)) log_line(LogLevel::kDebug, fmt::format(format, std::forward<Args>(args)...));
}
template <class... Args>
void log_info(fmt::format_string<Args...> format, Args&&... args) {
  log_line(LogLevel::kInfo, fmt::format(format, std::forward<Args>(args)...));
}
template <class... Args>
void log_warning(fmt::format_string<Args...> format, Args&&... args) {
  log_line(LogLevel::kWarning, fmt::format(format, std::forward<Args>(args)...));
}
template <class... Args>
void log_error(fmt::format_string<Args...> format, Args&&... args) {
  log_line(LogLevel::kError, fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace rumi
