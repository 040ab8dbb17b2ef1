// SPDX-License-Identifier: BSD-3-Clause
#include "formats/image/grey_range.h"

#include <algorithm>
#include <charconv>

#include "base/running/log.h"

namespace rumi {

std::optional<GreyRange> parse_grey_range(const std::string& text) {
  constexpr int kMax = 65535;
  GreyRange range;
  const char* end = text.data() + text.size();
  const auto low = std::from_chars(text.data(), end, range.low);
  if (low.ec != std::errc() || low.ptr == end || *low.ptr != ':') return std::nullopt;
  const auto high = std::from_chars(low.ptr + 1, end, range.high);
  if (high.ec != std::errc() || high.ptr != end) return std::nullopt;
  if (range.low < 0 || range.high > kMax || range.low >= range.high) return std::nullopt;
  return range;
}

cv::Mat to_8_bit(const cv::Mat& pixels, const GreyRange& range) {
  const double scale = 255.0 / (range.high - range.low);
  cv::Mat out;
  pixels.convertTo(out, CV_8U, scale, -range.low * scale);
  return out;
}

void GreyHistogram::add(const cv::Mat& pixels) {
  if (pixels.type() != CV_16UC1) return;
  for (int y = 0; y < pixels.rows; ++y)
    for (int x = 0; x < pixels.cols; ++x) ++counts_[pixels.ptr<uint16_t>(y)[x]];
  pixels_ += static_cast<int64_t>(pixels.total());
}

GreyRange GreyHistogram::range() const {
  constexpr double kTail = 0.001;
  if (pixels_ == 0) return {};
  const auto at = [this](int64_t rank) {
    int value = 0;
    for (int64_t below = counts_[0]; below <= rank; below += counts_[static_cast<size_t>(value)]) ++value;
    return value;
  };
  const auto tail = static_cast<int64_t>(kTail * static_cast<double>(pixels_));
  const int low = at(tail), high = at(pixels_ - 1 - tail);
  return {std::min(low, 65534), std::max(high, low + 1)};
}

void tell_grey_range(const std::string& recording, const GreyRange& range) {
  log_info(
      "{}: pixels of 16 bits: {} to {} become 0 to 255 in all images, the range of some of them; for another one "
      "give --set camera_driver.grey_range=LOW:HIGH",
      recording, range.low, range.high);
}

}  // namespace rumi
