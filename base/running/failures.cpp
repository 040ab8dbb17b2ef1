// SPDX-License-Identifier: BSD-3-Clause
#include "base/running/failures.h"

#include <fmt/format.h>
#include <yaml-cpp/exceptions.h>

#include <cstring>
#include <filesystem>
#include <new>

#include "base/running/log.h"
#include "base/this_process/account_limits.h"

namespace rumi {

namespace {

constexpr int64_t kLogPeriodUs = 60'000'000;

// Takes the reason out of OpenCV's text: what stands behind the second bracket, without the function. "OpenCV(4.6.0)
// ./modules/core/src/alloc.cpp:73: error: (-4:Insufficient memory) Failed to allocate 12 bytes in function
// 'OutOfMemoryError'".
std::string opencv_reason(const std::string& text) {
  const size_t error = text.find("error: (");
  const size_t begin = error == std::string::npos ? error : text.find(") ", error);
  if (begin == std::string::npos) return text;
  if (text.find("Failed to allocate") != std::string::npos) return no_memory_text();
  const std::string reason = text.substr(begin + 2, text.find(" in function", begin) - begin - 2);
  return "OpenCV cannot work on an image: " + reason;
}

// Replaces the prefix in "[json.exception.type_error.316] invalid UTF-8 byte at index 1: 0xFC".
std::string json_reason(const std::string& text) {
  const size_t end = text.find("] ");
  return end == std::string::npos ? text : "JSON that cannot be read or written: " + text.substr(end + 2);
}

std::string file_reason(const std::filesystem::filesystem_error& error) {
  std::string files = error.path1().string();
  if (!error.path2().empty()) files += " to " + error.path2().string();
  const std::string reason = error.code().message();
  return files.empty() ? reason : fmt::format("{}: {}", files, reason);
}

// libfmt's text for any file that it cannot print to: "cannot write to file: No space left on device".
constexpr const char* kNotPrinted = "cannot write to file: ";

}  // namespace

std::string reason_of(const std::exception& thrown) {
  if (const auto* file = dynamic_cast<const std::filesystem::filesystem_error*>(&thrown)) return file_reason(*file);
  if (dynamic_cast<const std::bad_alloc*>(&thrown)) return no_memory_text();
  const std::string text = thrown.what();
  if (const auto* yaml = dynamic_cast<const YAML::Exception*>(&thrown))
    return yaml->mark.is_null() ? "YAML that cannot be read: " + yaml->msg
                                : fmt::format("YAML that cannot be read: line {}: {}", yaml->mark.line + 1, yaml->msg);
  if (text.starts_with(kNotPrinted)) return "cannot write: " + text.substr(std::strlen(kNotPrinted));
  if (text.starts_with("[json.exception.")) return json_reason(text);
  if (text.starts_with("OpenCV(")) return opencv_reason(text);
  if (text.starts_with("pthread_create has failed")) return no_thread_text();  // from TBB, which OpenCV uses
  return text.empty() ? "no reason given" : text;
}

std::string what_was_thrown() {
  try {
    throw;
  } catch (const std::exception& e) {
    return reason_of(e);
  } catch (...) {
    return "what was thrown is no std::exception";
  }
}

void Failures::note(const std::string& reason, int64_t now_us, int64_t count) {
  if (reason.empty()) return;
  count_ += count;
  reason_ = reason;
  news_ = true;
  if (!is_due(now_us, last_log_us_, kLogPeriodUs)) return;
  last_log_us_ = now_us;
  log_error("{}", text());
}

std::string Failures::text() const {
  return count_ == 0 ? "" : fmt::format("{} broke off ({} so far): {}", what_, count_, reason_);
}

}  // namespace rumi
