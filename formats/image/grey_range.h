// SPDX-License-Identifier: BSD-3-Clause
// Converts pixels of 16 bits, as cameras for machine vision and thermal cameras give them, to the 8 bits that all
// programs work with.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

namespace rumi {

// Pixels of `low` and less become 0, those of `high` and more 255; linear between.
struct GreyRange {
  int low = 0, high = 65535;  // low < high
};

// Parses "LOW:HIGH"; nullopt for any other text.
std::optional<GreyRange> parse_grey_range(const std::string& text);

// Precondition: 16 bits without sign, 1 or 3 channels.
cv::Mat to_8_bit(const cv::Mat& pixels, const GreyRange& range);

// A histogram of some images of a recording.
class GreyHistogram {
 public:
  static constexpr size_t kMostImages = 16;  // more images would not change the range

  // Images that do not have one channel of 16 bits do not count.
  void add(const cv::Mat& pixels);
  // Returns the range without the darkest and the brightest thousandth of the pixels; the full 16 bits if there are no
  // pixels.
  GreyRange range() const;

 private:
  std::vector<int64_t> counts_ = std::vector<int64_t>(65536);
  int64_t pixels_ = 0;
};

// Logs the range, once for each recording.
void tell_grey_range(const std::string& recording, const GreyRange& range);

}  // namespace rumi
