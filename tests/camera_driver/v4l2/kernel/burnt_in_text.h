// SPDX-License-Identifier: BSD-3-Clause
// vivid writes its clock and the number of the frame into the picture: " hh:mm:ss:mmm number ...". What its digits look
// like is learnt from frames whose number is known.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace rumi::testing {

class BurntInText {
 public:
  // Grey pixels, `stride` bytes from row to row, of a frame with this number.
  void learn(const uint8_t* pixels, int stride, uint32_t number) {
    const std::string digits = std::to_string(number);
    for (size_t i = 0; i < digits.size(); ++i)
      glyphs_[glyph(pixels, stride, kNumber + static_cast<int>(i))] = digits[i];
  }
  size_t digits_known() const { return glyphs_.size(); }
  // Milliseconds since the stream began, as vivid counts them.
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
  static constexpr int kNumber = 14;                                     // its first column
  static constexpr int kWidth = 8, kHeight = 16, kLeft = 16, kTop = 16;  // pixels: of a glyph, of the text's corner
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
