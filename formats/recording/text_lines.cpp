// SPDX-License-Identifier: BSD-3-Clause
#include "formats/recording/text_lines.h"

#include "base/files/file_access.h"

namespace rumi {

TextLines::TextLines(const std::filesystem::path& file) : stream_(file, std::ios::binary) {
  if (!stream_) {
    const std::string why = why_unreadable(file);
    error_ = why.empty() ? "cannot be read" : why;
    return;
  }
  std::string mark(3, '\0');
  stream_.read(mark.data(), static_cast<std::streamsize>(mark.size()));
  if (mark.starts_with("\xFF\xFE") || mark.starts_with("\xFE\xFF"))
    error_ = "is text in UTF-16; save it as UTF-8 (`iconv -f UTF-16 -t UTF-8 FILE > OTHER`)";
  stream_.clear();
  stream_.seekg(mark == "\xEF\xBB\xBF" ? 3 : 0);
}

bool TextLines::next(std::string* line) {
  constexpr size_t kLongest = 20'000;
  line->clear();
  char c = 0;
  bool is_any = false;
  while (stream_.get(c)) {
    is_any = true;
    if (c == '\r' && stream_.peek() == '\n') stream_.get(c);
    if (c == '\n' || c == '\r') break;
    if (line->size() < kLongest) *line += c;
  }
  return is_any;
}

}  // namespace rumi
