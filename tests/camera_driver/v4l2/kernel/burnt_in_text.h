// SPDX-License-Identifier: BSD-3-Clause
// Reads the text that vivid writes into the picture, its clock and the number of the frame: " hh:mm:ss:mmm number ...".
// The shapes of the digits are learnt from frames whose number is known.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace rumi::testing {

class BurntInText {
 public:
  // Learns the digits from a frame with this number. `pixels` are grey, with `stride` bytes from row to row.
  void learn(const uint8_t* pixels, int stride, uint32_t number) {
    const std::string digits = std::to_string(number);
    for (size_t i = 0; i < digits.size(); ++i)
      glyphs_[glyph(pixels, stride, kNumber + static_cast<int>(i))] = digits[i];
  }
  size_t digits_known() const { return glyphs_.size(); }
  // Returns the milliseconds since the stream began, as vivid counts them; nullopt if a digit is not known yet.
  std::optional<int64_t> clock_ms(const uint8_t* pixels, int stride) const {
    int64_t ms = 0;
    const std::array<std::pair<int, int>, 9> places = {{{1, 36'000'000},
                                                        {2, 3'600'000},
                                                        {4, 600'000},
                                                        {5, 60'000},
                                                        {7, 10'000},
                                                        {8, 1000},
                                                        {10, 100},
                                                        {11, 10},
                                                        {12, 1}}};
    for (const auto& [column, worth] : places) {
      const auto it = glyphs_.find(glyph(pixels, stride, column));
      if (it == glyphs_.end()) return std::nullopt;
      ms += int64_t{it->second - '0'} * worth;
    }
    return ms;
  }

 private:
  static constexpr int kNumber = 14;  // column in the text at which the number begins
  static constexpr int kWidth = 8, kHeight = 16, kLeft = 16, kTop = 16;  // pixels: size of a glyph, corner of the text
  static std::string glyph(const uint8_t* pixels, int stride, int column) {
    std::string bytes;
    for (int y = 0; y < kHeight; ++y) {
      const uint8_t* row = pixels + int64_t{kTop + y} * stride + kLeft + column * kWidth;
      bytes.append(reinterpret_cast<const char*>(row), kWidth);
    }
    return bytes;
  }
  std::map<std::string, char> glyphs_;
};

}  // namespace rumi::testing
