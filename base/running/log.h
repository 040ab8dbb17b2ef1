// SPDX-License-Identifier: BSD-3-Clause
// Writes lines for a person to stderr, with the time and the process's name. Only log.cpp includes spdlog's headers:
// they would bring all of fmt into every file.
#pragma once

#include <fmt/format.h>

#include <string>
#include <utility>

namespace rumi {

enum class LogLevel { kDebug, kInfo, kWarning, kError };

// Sets the name that lines show, and the lowest level that is logged: info; `verbose`: debug; `quiet`: warning.
void start_logging(const std::string& name, bool verbose, bool quiet);

void log_line(LogLevel level, const std::string& text);
bool is_logged(LogLevel level);

// Does not format the arguments of lines that are not logged.
template <class... Args>
void log_at(LogLevel level, fmt::format_string<Args...> format, Args&&... args) {
  if (is_logged(level)) log_line(level, fmt::format(format, std::forward<Args>(args)...));
}

template <class... Args>
void log_debug(fmt::format_string<Args...> format, Args&&... args) {
  log_at(LogLevel::kDebug, format, std::forward<Args>(args)...);
}
template <class... Args>
void log_info(fmt::format_string<Args...> format, Args&&... args) {
  log_at(LogLevel::kInfo, format, std::forward<Args>(args)...);
}
template <class... Args>
void log_warning(fmt::format_string<Args...> format, Args&&... args) {
  log_at(LogLevel::kWarning, format, std::forward<Args>(args)...);
}
template <class... Args>
void log_error(fmt::format_string<Args...> format, Args&&... args) {
  log_at(LogLevel::kError, format, std::forward<Args>(args)...);
}

}  // namespace rumi
