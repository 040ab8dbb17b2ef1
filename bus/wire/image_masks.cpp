// SPDX-License-Identifier: BSD-3-Clause
#include "bus/wire/image_masks.h"

#include <fmt/format.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "bus/wire/image_codec.h"

namespace rumi {
namespace {

constexpr size_t kMostBytes = 16'000'000;

ImageMask mask_of_size(const std::string& bytes, const cv::Size& of_image, const cv::Size& wanted, std::string* error) {
  const cv::Mat pixels = decode_mask(bytes, error);
  if (pixels.empty()) return {};
  if (pixels.size() == of_image) return ImageMask(pixels).resized(wanted);
  *error = fmt::format("the mask is {} x {} pixels and the image {} x {}", pixels.cols, pixels.rows, of_image.width,
                       of_image.height);
  return {};
}

}  // namespace

std::string encode_mask(const cv::Mat& pixels) {
  std::vector<uchar> bytes;
  cv::imencode(".png", pixels != 0, bytes, {cv::IMWRITE_PNG_BILEVEL, 1});
  return {bytes.begin(), bytes.end()};
}

cv::Mat decode_mask(const std::string& bytes, std::string* error) {
  cv::Mat pixels;
  if (!bytes.empty() && bytes.size() <= kMostBytes) try {
      const std::vector<uchar> data(bytes.begin(), bytes.end());
      pixels = cv::imdecode(data, cv::IMREAD_UNCHANGED);
    } catch (const cv::Exception&) {  // of a size that OpenCV refuses
    }
  if (pixels.empty()) {
    *error = "the mask is no image that can be read";
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
    bytes_ = bytes;
    size_ = size;
  }
  *error = error_;
  return mask_;
}

}  // namespace rumi
