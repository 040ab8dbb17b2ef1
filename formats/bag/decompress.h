// SPDX-License-Identifier: BSD-3-Clause
// Decompresses chunks of bags. Sizes that a bag gives are not believed: memory grows with the bytes that really come
// out.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/image/byte_source.h"

namespace rumi {

enum class Compression { kNone, kBz2, kLz4, kZstd };

// Finds a compression by its name in a bag; nullopt if it is not known. "" and "none" are kNone.
std::optional<Compression> compression_named(const std::string& name);

struct Decompressed {
  std::vector<uint8_t> bytes;  // if the stream is damaged: the bytes before the damage
  bool is_whole = false;       // the stream was read up to its end mark
  bool is_cut_off = false;     // the stream is good, but ends before its end mark
  int64_t stored_bytes = 0;    // compressed bytes that were read
};

// Decompresses the stream that begins at `at` and takes at most `stored_bytes`. Not for kNone.
Decompressed decompress(ByteSource& source, int64_t at, int64_t stored_bytes, Compression compression);

bool looks_like_zstd(std::span<const uint8_t> bytes);

}  // namespace rumi
