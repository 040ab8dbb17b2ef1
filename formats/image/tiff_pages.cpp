// SPDX-License-Identifier: BSD-3-Clause
#include "formats/image/tiff_pages.h"

#include <algorithm>
#include <cstdint>
#include <optional>

#include "formats/image/byte_source.h"

namespace rumi {
namespace {

struct Page {
  uint32_t width = 0, height = 0;
  bool is_smaller_copy = false;
  int64_t next = 0;  // position of the next page's description; 0: this is the last page
};

class TiffReader {
 public:
  explicit TiffReader(const std::filesystem::path& file) : bytes_(file.string()) {
    std::vector<uint8_t> magic(4);
    if (!bytes_.read(0, magic)) return;
    is_big_endian_ = magic == std::vector<uint8_t>{'M', 'M', 0, '*'};
    if (is_big_endian_ || magic == std::vector<uint8_t>{'I', 'I', '*', 0}) first_ = number(4, 4).value_or(0);
  }
  int64_t first() const { return first_; }

  // Returns nullopt if the page's description is cut off.
  std::optional<Page> read(int64_t at) {
    constexpr uint32_t kKindTag = 254, kWidthTag = 256, kHeightTag = 257, kShort = 3;
    constexpr int64_t kEntryBytes = 12;
    const std::optional<uint32_t> entries = number(at, 2);
    if (!entries) return std::nullopt;
    Page page;
    for (int64_t entry = at + 2, end = entry + *entries * kEntryBytes; entry < end; entry += kEntryBytes) {
      const std::optional<uint32_t> tag = number(entry, 2), type = number(entry + 2, 2);
      const std::optional<uint32_t> value = number(entry + 8, type == kShort ? 2 : 4);
      if (!value) return std::nullopt;
      if (tag == kKindTag) page.is_smaller_copy = (*value & 1) != 0;
      if (tag == kWidthTag) page.width = *value;
      if (tag == kHeightTag) page.height = *value;
    }
    const std::optional<uint32_t> next = number(at + 2 + *entries * kEntryBytes, 4);
    if (!next) return std::nullopt;
    page.next = *next;
    return page;
  }

 private:
  std::optional<uint32_t> number(int64_t at, size_t count) {
    std::vector<uint8_t> bytes(count);
    if (!bytes_.read(at, bytes)) return std::nullopt;
    if (is_big_endian_) std::reverse(bytes.begin(), bytes.end());
    bytes.resize(sizeof(uint32_t));
    return little_endian<uint32_t>(bytes);
  }

  FileBytes bytes_;
  bool is_big_endian_ = false;
  int64_t first_ = 0;
};

}  // namespace

std::vector<int> pages_of_tiff(const std::filesystem::path& file) {
  constexpr int kMostPages = 100'000;  // a limit is needed, because descriptions may form a ring
  TiffReader reader(file);
  std::vector<int> pages;
  std::optional<Page> first;
  int64_t at = reader.first();
  for (int number = 0; at > 0 && number < kMostPages; ++number) {
    const std::optional<Page> page = reader.read(at);
    if (!page) break;
    if (!first) first = page;
    const bool is_alike = page->width == first->width && page->height == first->height;
    if (is_alike && !page->is_smaller_copy) pages.push_back(number);
    at = page->next;
  }
  return pages;
}

}  // namespace rumi
