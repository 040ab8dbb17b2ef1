// SPDX-License-Identifier: BSD-3-Clause
#include "bus/wire/image_masks.h"

#include <fmt/format.h>

#include <cstdint>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "bus/wire/image_codec.h"

namespace rumi {
namespace {

constexpr size_t kMostBytes = 16'000'000;
constexpr int64_t kMostPixels = 100'000'000;  // a PNG of a hundred bytes may ask for gigabytes

// A header that says so is believed before room is made for the pixels.
std::string why_unfit(const std::string& bytes, const cv::Size& of_image) {
  const cv::Size size = size_of_mask(bytes);
  if (size.empty() || size == of_image) return {};
  return fmt::format("the mask is {} x {} pixels and the image {} x {}", size.width, size.height, of_image.width,
                     of_image.height);
}

ImageMask mask_of_size(const std::string& bytes, const cv::Size& of_image, const cv::Size& wanted, std::string* error) {
  *error = why_unfit(bytes, of_image);
  return error->empty() ? ImageMask(decode_mask(bytes, error)).resized(wanted) : ImageMask();
}

}  // namespace

std::string encode_mask(const cv::Mat& pixels) {
  std::vector<uchar> bytes;
  cv::imencode(".png", pixels != 0, bytes, {cv::IMWRITE_PNG_BILEVEL, 1});
  return {bytes.begin(), bytes.end()};
}

cv::Size size_of_mask(std::string_view bytes) {
  constexpr std::string_view kBeginning{"\x89PNG\r\n\x1A\n\0\0\0\rIHDR", 16};
  if (bytes.size() < kMaskHeaderBytes || !bytes.starts_with(kBeginning)) return {};
  const auto side = [bytes](size_t at) {
    int64_t value = 0;
    for (size_t i = at; i < at + 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes[i]);
    return value;
  };
  constexpr int64_t kMostSide = 1'000'000;
  const int64_t width = side(16), height = side(20);
  if (width < 1 || height < 1 || width > kMostSide || height > kMostSide) return {};
  return {static_cast<int>(width), static_cast<int>(height)};
}

cv::Mat decode_mask(const std::string& bytes, std::string* error) {
  const cv::Size size = size_of_mask(bytes);
  if (int64_t{size.width} * size.height > kMostPixels || bytes.size() > kMostBytes) {
    *error = fmt::format("the mask is too large ({} x {} pixels in {} bytes)", size.width, size.height, bytes.size());
    return {};
  }
  cv::Mat pixels;
  if (!size.empty()) try {
      const std::vector<uchar> data(bytes.begin(), bytes.end());
      pixels = cv::imdecode(data, cv::IMREAD_UNCHANGED);
    } catch (const cv::Exception&) {  // one that OpenCV refuses
    }
  if (pixels.empty()) {
    *error = "the mask is no PNG that can be read";
    return {};
  }
  std::vector<cv::Mat> channels;
  cv::split(pixels, channels);
  if (channels.size() == 2 || channels.size() == 4) channels.pop_back();  // opacity
  cv::Mat world = channels.front() != 0;
  for (const cv::Mat& channel : channels) world |= channel != 0;
  return world;
}

const ImageMask& MaskReader::read(const image_t& image, const cv::Size& size, std::string* error) {
  const std::string bytes = metadata(image, kMaskKey);
  if (bytes != bytes_ || size != size_) {
    error_.clear();
    mask_ = bytes.empty() ? ImageMask() : mask_of_size(bytes, {image.width, image.height}, size, &error_);
    mask_ = mask_.and_also(always_.resized(size));
    bytes_ = bytes;
    size_ = size;
  }
  *error = error_;
  return mask_;
}

}  // namespace rumi
