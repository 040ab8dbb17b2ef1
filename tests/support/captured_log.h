// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace rumi::testing {

// Captures what is logged while an object lives, at this level and above. It does not appear elsewhere.
class CapturedLog {
 public:
  explicit CapturedLog(spdlog::level::level_enum level = spdlog::level::info) {
    sinks_ =
        std::exchange(spdlog::default_logger()->sinks(), {std::make_shared<spdlog::sinks::ostream_sink_mt>(text_)});
    spdlog::set_level(level);
  }
  ~CapturedLog() {
    spdlog::default_logger()->sinks() = std::move(sinks_);
    spdlog::set_level(level_);
  }
  CapturedLog(const CapturedLog&) = delete;
  CapturedLog& operator=(const CapturedLog&) = delete;
  std::string text() const { return text_.str(); }

 private:
  const spdlog::level::level_enum level_ = spdlog::get_level();
  std::vector<spdlog::sink_ptr> sinks_;
  std::ostringstream text_;
};

}  // namespace rumi::testing
