// SPDX-License-Identifier: BSD-3-Clause
// Lines for a person, to stderr with the time and the process's name. spdlog does it; only log.cpp includes its
// headers, which bring the whole of fmt into every file.
#pragma once

#include <fmt/format.h>

#include <string>
#include <utility>

namespace rumi {

enum class LogLevel { kDebug, kInfo, kWarning, kError };

// Sets the name of the lines; they are logged from info on, `verbose`: from debug, `quiet`: from warning.
void start_logging(const std::string& name, bool verbose, bool quiet);

void log_line(LogLevel level, const std::string& text);
bool is_logged(LogLevel level);

// Arguments of lines that are not logged are not formatted either.
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
