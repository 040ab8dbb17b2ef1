// SPDX-License-Identifier: BSD-3-Clause
// The reason why a file cannot be written now. Logged when it begins or changes, and when it ends.
#pragma once

#include <string>
#include <utility>

#include "base/result.h"

namespace rumi::map_server {

class WriteTrouble {
 public:
  explicit WriteTrouble(std::string file) : file_(std::move(file)) {}

  // Notes the result of the latest attempt to write the file.
  void note(const Result<>& written);
  bool is_over() const { return text_.empty(); }
  const std::string& text() const { return text_; }  // empty if the latest attempt succeeded

 private:
  std::string file_, text_;
};

}  // namespace rumi::map_server
