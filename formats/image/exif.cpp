// SPDX-License-Identifier: BSD-3-Clause
#include "formats/image/exif.h"

#include <algorithm>
#include <string_view>

namespace rumi {
namespace {

using Bytes = std::span<const uint8_t>;

uint32_t number(Bytes bytes, size_t at, size_t length, bool is_big_endian) {
  if (at + length > bytes.size()) return 0;
  uint32_t value = 0;
  for (size_t i = 0; i < length; ++i) value = value << 8 | bytes[is_big_endian ? at + i : at + length - 1 - i];
  return value;
}

bool begins_with(Bytes bytes, std::string_view text) {
  return bytes.size() >= text.size() && std::equal(text.begin(), text.end(), bytes.begin());
}

// Searches the directory of the TIFF structure in the EXIF data. Returns 1 (as stored) if it has no orientation.
int orientation_in_tiff(Bytes tiff) {
  constexpr uint32_t kOrientation = 0x0112;
  constexpr size_t kEntryBytes = 12;
  const bool is_big_endian = begins_with(tiff, "MM");
  const size_t directory = number(tiff, 4, 4, is_big_endian);
  const size_t entries = number(tiff, directory, 2, is_big_endian);
  for (size_t i = 0; i < entries; ++i) {
    const size_t entry = directory + 2 + i * kEntryBytes;
    if (entry + kEntryBytes > tiff.size()) break;
    if (number(tiff, entry, 2, is_big_endian) != kOrientation) continue;
    const uint32_t value = number(tiff, entry + 8, 2, is_big_endian);
    return value >= 1 && value <= 8 ? static_cast<int>(value) : 1;
  }
  return 1;
}

}  // namespace

int exif_orientation(Bytes jpeg) {
  using namespace std::string_view_literals;
  constexpr uint8_t kApp1 = 0xE1, kScan = 0xDA;
  constexpr std::string_view kMark = "Exif\0\0"sv;
  for (size_t at = 2; at + 4 <= jpeg.size() && jpeg[at] == 0xFF && jpeg[at + 1] != kScan;) {
    const size_t length = number(jpeg, at + 2, 2, true);
    if (length < 2 || at + 2 + length > jpeg.size()) break;
    const Bytes segment = jpeg.subspan(at + 4, length - 2);
    if (jpeg[at + 1] == kApp1 && begins_with(segment, kMark)) return orientation_in_tiff(segment.subspan(kMark.size()));
    at += 2 + length;
  }
  return 1;
}

}  // namespace rumi
