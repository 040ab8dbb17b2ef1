// SPDX-License-Identifier: BSD-3-Clause
#include "bus/wire/image_codec.h"

#include <fmt/format.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "bus/wire/jpeg_decoder.h"
#include "slam/geometry/max_side.h"

namespace rumi {
namespace {

// Returns the bytes per pixel of a raw format, 0 for JPEG, and -1 for an unknown format.
int bytes_per_pixel(int32_t pixelformat) {
  switch (pixelformat) {
    case image_t::PIXEL_FORMAT_GRAY:
      return 1;
    case image_t::PIXEL_FORMAT_RGB:
      return 3;
    case image_t::PIXEL_FORMAT_YUYV:
      return 2;
    case image_t::PIXEL_FORMAT_MJPEG:
      return 0;
    default:
      return -1;
  }
}

Result<> check_jpeg(const image_t& image) {
  if (image.size == 0) return Error{"size is 0: no JPEG data"};
  const Result<JpegSize> size = inspect_jpeg(image.data);
  if (!size) return size.error();
  // Checked before decoding: a small file that claims 65535 x 65535 pixels must be refused without being unpacked.
  if (size->width == image.width && size->height == image.height) return {};
  return Error{fmt::format("the JPEG is {} x {} pixels but width x height is {} x {}", size->width, size->height,
                           image.width, image.height)};
}

// Returns the message's pixels without copying them; valid as long as the message.
cv::Mat view(const image_t& image, int type) {
  return {image.height, image.width, type, const_cast<uint8_t*>(image.data.data()),
          static_cast<size_t>(image.row_stride)};
}

image_t make_raw(int64_t utime_us, const cv::Mat& pixels, int32_t pixelformat) {
  image_t image;
  image.utime = utime_us;
  image.width = pixels.cols;
  image.height = pixels.rows;
  image.row_stride = static_cast<int32_t>(pixels.cols * pixels.elemSize());
  image.pixelformat = pixelformat;
  image.data.resize(static_cast<size_t>(image.row_stride) * pixels.rows);
  pixels.copyTo(cv::Mat(pixels.rows, pixels.cols, pixels.type(), image.data.data()));
  image.size = static_cast<int32_t>(image.data.size());
  image.nmetadata = 0;
  return image;
}

// Returns a name such as " (NV12)", or an empty string. Most formats are V4L2's four letters, others are numbers of
// libbot.
std::string name_of_format(int32_t format) {
  constexpr int32_t kGray16 = 357, kRgb16 = 358;
  if (format == kGray16) return " (GRAY of 16 bits)";
  if (format == kRgb16) return " (RGB of 16 bits)";
  std::string letters;
  for (int i = 0; i < 4; ++i) letters += static_cast<char>(static_cast<uint32_t>(format) >> 8 * i & 0xff);
  const bool are_letters = std::all_of(letters.begin(), letters.end(), [](char c) { return c >= ' ' && c <= '~'; });
  return are_letters ? fmt::format(" ({})", letters) : "";
}

}  // namespace

// Messages come from the network: all of this is checked before a pixel is read.
Result<> check_image(const image_t& image) {
  const int bytes = bytes_per_pixel(image.pixelformat);
  if (bytes < 0)
    return Error{fmt::format("pixelformat is {}{}: supported are GRAY {}, RGB {}, MJPEG {} and YUYV {}",
                             image.pixelformat, name_of_format(image.pixelformat), int{image_t::PIXEL_FORMAT_GRAY},
                             int{image_t::PIXEL_FORMAT_RGB}, int{image_t::PIXEL_FORMAT_MJPEG},
                             int{image_t::PIXEL_FORMAT_YUYV})};
  if (image.width < 1 || image.width > kMaxSide)
    return Error{fmt::format("width is {}: must be 1 to {}", image.width, kMaxSide)};
  if (image.height < 1 || image.height > kMaxSide)
    return Error{fmt::format("height is {}: must be 1 to {}", image.height, kMaxSide)};
  if (image.size < 0 || static_cast<size_t>(image.size) != image.data.size())
    return Error{fmt::format("size is {} but data has {} bytes", image.size, image.data.size())};
  if (bytes == 0) return check_jpeg(image);
  if (image.pixelformat == image_t::PIXEL_FORMAT_YUYV && image.width % 2 != 0)
    return Error{fmt::format("width is {}: must be even for YUYV", image.width)};
  const int64_t row = int64_t{image.width} * bytes;
  if (image.row_stride < row)
    return Error{
        fmt::format("row_stride is {}: must be at least {} for a width of {}", image.row_stride, row, image.width)};
  // The last row may lack its padding.
  const int64_t needed = int64_t{image.row_stride} * (image.height - 1) + row;
  if (image.size < needed)
    return Error{fmt::format("size is {}: must be at least {} for {} rows of {} bytes", image.size, needed,
                             image.height, image.row_stride)};
  return {};
}

namespace {

Result<cv::Mat> decode(const image_t& image, bool grey) {
  if (const Result<> checked = check_image(image); !checked) return checked.error();
  cv::Mat out;
  switch (image.pixelformat) {
    case image_t::PIXEL_FORMAT_MJPEG:
      return decode_jpeg(image.data, grey);
    case image_t::PIXEL_FORMAT_RGB:
      cv::cvtColor(view(image, CV_8UC3), out, grey ? cv::COLOR_RGB2GRAY : cv::COLOR_RGB2BGR);
      return out;
    case image_t::PIXEL_FORMAT_YUYV:
      cv::cvtColor(view(image, CV_8UC2), out, grey ? cv::COLOR_YUV2GRAY_YUYV : cv::COLOR_YUV2BGR_YUYV);
      return out;
    default:
      if (grey) return view(image, CV_8UC1).clone();
      cv::cvtColor(view(image, CV_8UC1), out, cv::COLOR_GRAY2BGR);
      return out;
  }
}

}  // namespace

Result<cv::Mat> decode_grey(const image_t& image) { return decode(image, true); }

Result<cv::Mat> decode_reduced_grey(const image_t& image, int reduction) {
  if (image.pixelformat == image_t::PIXEL_FORMAT_MJPEG) {
    if (const Result<> checked = check_image(image); !checked) return checked.error();
    return decode_jpeg(image.data, true, reduction);
  }
  const Result<cv::Mat> grey = decode_grey(image);
  if (!grey || reduction == 1) return grey;
  const cv::Size size((grey->cols + reduction - 1) / reduction, (grey->rows + reduction - 1) / reduction);
  cv::Mat reduced;
  cv::resize(*grey, reduced, size, 0, 0, cv::INTER_AREA);
  return reduced;
}

Result<cv::Mat> decode_bgr(const image_t& image) { return decode(image, false); }

image_t make_grey_image(int64_t utime_us, const cv::Mat& grey) {
  CV_Assert(grey.type() == CV_8UC1);
  return make_raw(utime_us, grey, image_t::PIXEL_FORMAT_GRAY);
}

image_t make_rgb_image(int64_t utime_us, const cv::Mat& bgr) {
  CV_Assert(bgr.type() == CV_8UC3);
  cv::Mat rgb;
  cv::cvtColor(bgr, rgb, cv::COLOR_BGR2RGB);
  return make_raw(utime_us, rgb, image_t::PIXEL_FORMAT_RGB);
}

image_t wrap_jpeg(int64_t utime_us, int width, int height, std::vector<uint8_t> jpeg) {
  image_t image;
  image.utime = utime_us;
  image.width = width;
  image.height = height;
  image.row_stride = 0;
  image.pixelformat = image_t::PIXEL_FORMAT_MJPEG;
  image.size = static_cast<int32_t>(jpeg.size());
  image.data = std::move(jpeg);
  image.nmetadata = 0;
  return image;
}

std::string_view metadata(const image_t& image, std::string_view key) {
  for (const image_metadata_t& entry : image.metadata)
    if (entry.key == key) return {reinterpret_cast<const char*>(entry.value.data()), entry.value.size()};
  return {};
}

void set_metadata(image_t* image, const std::string& key, std::string_view value) {
  auto entry = std::find_if(image->metadata.begin(), image->metadata.end(),
                            [&key](const image_metadata_t& m) { return m.key == key; });
  if (entry == image->metadata.end()) {
    image->metadata.emplace_back();
    entry = image->metadata.end() - 1;
    entry->key = key;
  }
  entry->value.assign(value.begin(), value.end());
  entry->n = static_cast<int32_t>(value.size());
  image->nmetadata = static_cast<int32_t>(image->metadata.size());
}

}  // namespace rumi
