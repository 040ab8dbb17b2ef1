// SPDX-License-Identifier: BSD-3-Clause
// From pixels of 16 bits, as cameras for machine vision and thermal ones give, to the 8 that everything works with.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

namespace rumi {

// `low` and less become 0, `high` and more 255, linearly between.
struct GreyRange {
  int low = 0, high = 65535;  // low < high
};

// "LOW:HIGH"; nothing for anything else.
std::optional<GreyRange> parse_grey_range(const std::string& text);

// Precondition: 16 bits without sign, 1 or 3 channels.
cv::Mat to_8_bit(const cv::Mat& pixels, const GreyRange& range);

// Of some images of a recording.
class GreyHistogram {
 public:
  static constexpr size_t kMostImages = 16;  // that are worth adding

  // Images that do not have one channel of 16 bits do not count.
  void add(const cv::Mat& pixels);
  // That of all pixels but for the darkest and the brightest thousandth; all of 16 bits if there are none.
  GreyRange range() const;

 private:
  std::vector<int64_t> counts_ = std::vector<int64_t>(65536);
  int64_t pixels_ = 0;
};

// For the log, once a recording.
void tell_grey_range(const std::string& recording, const GreyRange& range);

}  // namespace rumi
