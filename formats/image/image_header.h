// SPDX-License-Identifier: BSD-3-Clause
// Reads the size that an image file claims to have. Decoders allocate memory for it at once: a file of a hundred bytes
// may ask for gigabytes.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace rumi {

struct HeaderSize {
  int64_t width = 0, height = 0;  // as the file says: they may be any numbers
};

// Reads the header of a PNG, BMP, PGM, PPM (PNM), TIFF or WebP file; nullopt for other files, and if the header is cut
// short.
std::optional<HeaderSize> size_in_header(std::span<const uint8_t> file);

// Returns the value of white in a binary PGM or PPM file of 8 bits (P5, P6), which decoders do not look at; 255 for all
// other files.
int white_in_header(std::span<const uint8_t> file);

}  // namespace rumi
