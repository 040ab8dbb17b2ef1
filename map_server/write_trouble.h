// SPDX-License-Identifier: BSD-3-Clause
// Why a file cannot be written now. The log says it once when it begins, and once when the file can be written again.
#pragma once

#include <string>
#include <utility>

#include "base/result.h"

namespace rumi::map_server {

class WriteTrouble {
 public:
  explicit WriteTrouble(std::string file) : file_(std::move(file)) {}

  // Takes the result of the latest attempt to write the file.
  void note(const Result<>& written);
  bool is_over() const { return text_.empty(); }
  const std::string& text() const { return text_; }  // empty if the latest attempt went well

 private:
  std::string file_, text_;
};

}  // namespace rumi::map_server
