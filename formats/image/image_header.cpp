// SPDX-License-Identifier: BSD-3-Clause
#include "formats/image/image_header.h"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <string_view>

namespace rumi {
namespace {

using File = std::span<const uint8_t>;

constexpr int64_t kMostPnm = 1'000'000'000;  // a larger number counts as this one

bool has(File file, size_t at, std::string_view text) {
  return file.size() >= at + text.size() && std::memcmp(&file[at], text.data(), text.size()) == 0;
}

// Reads a little-endian number. Precondition: the bytes are there.
uint32_t little(File file, size_t at, int bytes) {
  uint32_t value = 0;
  for (int i = bytes - 1; i >= 0; --i) value = value << 8 | file[at + static_cast<size_t>(i)];
  return value;
}

uint32_t big(File file, size_t at, int bytes) {
  uint32_t value = 0;
  for (int i = 0; i < bytes; ++i) value = value << 8 | file[at + static_cast<size_t>(i)];
  return value;
}

std::optional<HeaderSize> png_size(File file) {
  if (file.size() < 24 || !has(file, 12, "IHDR")) return std::nullopt;
  return HeaderSize{big(file, 16, 4), big(file, 20, 4)};
}

std::optional<HeaderSize> bmp_size(File file) {
  constexpr uint32_t kOldHeader = 12;
  if (file.size() < 26) return std::nullopt;
  if (little(file, 14, 4) == kOldHeader) return HeaderSize{little(file, 18, 2), little(file, 20, 2)};
  const int64_t height = static_cast<int32_t>(little(file, 22, 4));  // negative: rows are stored from the top
  return HeaderSize{little(file, 18, 4), height < 0 ? -height : height};
}

// Reads the next number of a PNM header, after blanks and comments; nullopt if there is none.
std::optional<int64_t> pnm_number(File file, size_t* at) {
  while (*at < file.size() && (std::isspace(file[*at]) != 0 || file[*at] == '#')) {
    if (file[*at] == '#')
      while (*at < file.size() && file[*at] != '\n' && file[*at] != '\r') ++*at;
    else
      ++*at;
  }
  if (*at >= file.size() || std::isdigit(file[*at]) == 0) return std::nullopt;
  int64_t value = 0;
  for (; *at < file.size() && std::isdigit(file[*at]) != 0; ++*at)
    value = std::min(kMostPnm, 10 * value + file[*at] - '0');
  return value;
}

std::optional<HeaderSize> pnm_size(File file) {
  size_t at = 2;
  const std::optional<int64_t> width = pnm_number(file, &at);
  const std::optional<int64_t> height = width ? pnm_number(file, &at) : std::nullopt;
  if (!height) return std::nullopt;
  return HeaderSize{*width, *height};
}

// Reads the size of the first picture in the file; nullopt if the header is broken. If a tag is there twice, the larger
// value counts.
std::optional<HeaderSize> tiff_size(File file, uint32_t (*number)(File, size_t, int)) {
  constexpr uint32_t kWidthTag = 256, kHeightTag = 257, kShort = 3, kLong = 4;
  constexpr size_t kEntryBytes = 12;
  if (file.size() < 8) return std::nullopt;
  const size_t directory = number(file, 4, 4);
  if (directory > file.size() || file.size() - directory < 2) return std::nullopt;
  const size_t entries = number(file, directory, 2);
  if (entries > (file.size() - directory - 2) / kEntryBytes) return std::nullopt;
  HeaderSize size;
  for (size_t i = 0; i < entries; ++i) {
    const size_t at = directory + 2 + i * kEntryBytes;
    const uint32_t tag = number(file, at, 2), type = number(file, at + 2, 2);
    if (tag != kWidthTag && tag != kHeightTag) continue;
    if (type != kShort && type != kLong) return std::nullopt;  // libtiff reads values of other types at another place
    int64_t& side = tag == kWidthTag ? size.width : size.height;
    side = std::max<int64_t>(side, number(file, at + 8, type == kShort ? 2 : 4));
  }
  return size;
}

std::optional<HeaderSize> webp_size(File file) {
  constexpr uint32_t kSide = 0x3fff;  // 14 bits
  if (file.size() < 30) return std::nullopt;
  if (has(file, 12, "VP8X")) return HeaderSize{int64_t{little(file, 24, 3)} + 1, int64_t{little(file, 27, 3)} + 1};
  if (has(file, 12, "VP8L")) {
    const uint32_t bits = little(file, 21, 4);
    return HeaderSize{int64_t{bits & kSide} + 1, int64_t{bits >> 14 & kSide} + 1};
  }
  return HeaderSize{little(file, 26, 2) & kSide, little(file, 28, 2) & kSide};
}

}  // namespace

std::optional<HeaderSize> size_in_header(File file) {
  using namespace std::string_view_literals;
  if (has(file, 0, "\x89PNG\r\n\x1a\n"sv)) return png_size(file);
  if (has(file, 0, "BM"sv)) return bmp_size(file);
  if (file.size() > 2 && file[0] == 'P' && file[1] >= '1' && file[1] <= '6') return pnm_size(file);
  if (has(file, 0, "II*\0"sv)) return tiff_size(file, little);
  if (has(file, 0, "MM\0*"sv)) return tiff_size(file, big);
  if (has(file, 0, "RIFF"sv) && has(file, 8, "WEBP"sv)) return webp_size(file);
  return std::nullopt;
}

int white_in_header(File file) {
  constexpr int64_t kWhite = 255;
  if (!has(file, 0, "P5") && !has(file, 0, "P6")) return kWhite;
  size_t at = 2;
  std::optional<int64_t> number;
  for (int i = 0; i < 3; ++i) number = pnm_number(file, &at);  // width, height, white
  return static_cast<int>(std::clamp(number.value_or(kWhite), int64_t{1}, kWhite));
}

}  // namespace rumi
