// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/write_trouble.h"

#include "base/running/log.h"

namespace rumi::map_server {

void WriteTrouble::note(const Result<>& written) {
  const std::string before = std::exchange(text_, written.error_text());
  if (text_ == before) return;
  if (text_.empty())
    log_info("{} can be written again, nothing is missing in it", file_);
  else
    log_error("{}", text_);
}

}  // namespace rumi::map_server
