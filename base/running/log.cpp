// SPDX-License-Identifier: BSD-3-Clause
#include "base/running/log.h"

#include <glog/logging.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

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

void start_logging(const std::string& name, bool verbose, bool quiet) {
  // A logger with this name may exist already if several mains run in one process, as in tests.
  spdlog::drop(name);
  spdlog::set_default_logger(spdlog::stderr_color_mt(name));
  // A terminal may show a progress line: each line of the log overwrites it.
  const std::string erase = isatty(STDERR_FILENO) ? "\r\x1b[K" : "";
  spdlog::set_pattern(erase + "%H:%M:%S.%e %n %^%l%$ %v");
  FLAGS_minloglevel = google::GLOG_FATAL;  // else Ceres logs every step that it rejects
  spdlog::set_level(quiet ? spdlog::level::warn : verbose ? spdlog::level::debug : spdlog::level::info);
}

void log_line(LogLevel level, const std::string& text) { spdlog::log(spdlog_level(level), "{}", text); }
bool is_logged(LogLevel level) { return spdlog::should_log(spdlog_level(level)); }

}  // namespace rumi
