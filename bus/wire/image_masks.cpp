// SPDX-License-Identifier: BSD-3-Clause
#include "bus/wire/image_masks.h"

#include <fmt/format.h>

#include <cstdint>
#include <opencv2/imgproc.hpp>

#include "bus/wire/image_codec.h"
#include "bus/wire/mask_png.h"

namespace rumi {
namespace {

constexpr size_t kMostBytes = 16'000'000;
constexpr int64_t kMostPixels = 100'000'000;  // a PNG of a hundred bytes may ask for gigabytes

// Decodes the mask of an image of the given size. The size in the mask's header is checked before memory is allocated
// for the pixels; an Error if it is another one.
Result<cv::Mat> decode_mask_of(const cv::Size& image, std::string_view bytes) {
  const cv::Size size = size_of_mask(bytes);
  if (size.empty() || size == image) return decode_mask(bytes);
  return Error{fmt::format("the mask is {} x {} pixels and the image {} x {}", size.width, size.height, image.width,
                           image.height)};
}

}  // namespace

std::string encode_mask(const cv::Mat& pixels) { return mask_to_png(pixels); }

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

Result<cv::Mat> decode_mask(std::string_view bytes) {
  const cv::Size size = size_of_mask(bytes);
  if (int64_t{size.width} * size.height > kMostPixels || bytes.size() > kMostBytes)
    return Error{
        fmt::format("the mask is too large ({} x {} pixels in {} bytes)", size.width, size.height, bytes.size())};
  cv::Mat world = size.empty() ? cv::Mat() : mask_from_png(bytes, size);
  if (world.empty()) return Error{"the mask is no PNG that can be read"};
  return world;
}

const ImageMask& MaskReader::read(const image_t& image, const cv::Size& size) {
  const std::string_view bytes = metadata(image, kMaskKey);
  if (bytes == bytes_ && size == size_) return mask_;
  problem_.clear();
  mask_ = ImageMask();
  if (!bytes.empty()) {
    const Result<cv::Mat> pixels = decode_mask_of({image.width, image.height}, bytes);
    if (pixels) mask_ = ImageMask(*pixels).resized(size);
    problem_ = pixels.error_text();
  }
  mask_ = mask_.and_also(always_.resized(size));
  bytes_ = bytes;
  size_ = size;
  return mask_;
}

}  // namespace rumi
