// SPDX-License-Identifier: BSD-3-Clause
// The compressions of bags: what they say of sizes is not believed, memory grows with what really comes out.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/image/byte_source.h"

namespace rumi {

enum class Compression { kNone, kBz2, kLz4, kZstd };

// Finds a compression by its name in a bag; nothing if it is not known. "" and "none" are kNone.
std::optional<Compression> compression_named(const std::string& name);

struct Decompressed {
  std::vector<uint8_t> bytes;  // of a damaged stream: the bytes before the damage
  bool is_whole = false;       // up to the mark of its end
  bool is_cut_off = false;     // good, but without that mark
  int64_t stored_bytes = 0;    // that it took
};

// The stream that begins at `at`, of at most `stored_bytes`. Not for kNone.
Decompressed decompress(ByteSource& source, int64_t at, int64_t stored_bytes, Compression compression);

bool looks_like_zstd(std::span<const uint8_t> bytes);

}  // namespace rumi
