// SPDX-License-Identifier: BSD-3-Clause
#include "formats/image/image_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <string_view>

#include "base/files/file_access.h"
#include "bus/wire/image_codec.h"
#include "bus/wire/jpeg_decoder.h"
#include "formats/image/image_header.h"
#include "formats/image/library_messages.h"
#include "slam/geometry/max_side.h"

namespace rumi {
namespace {

namespace fs = std::filesystem;
constexpr std::uintmax_t kMaxFileBytes = 512u << 20;

bool is_lfs_pointer(const std::vector<uint8_t>& bytes) {
  constexpr std::string_view kMark = "version https://git-lfs";
  return bytes.size() > kMark.size() && std::equal(kMark.begin(), kMark.end(), bytes.begin());
}

std::optional<std::vector<uint8_t>> read_file(const fs::path& file, std::string* error) {
  std::error_code code;
  if (!fs::is_regular_file(file, code)) {
    const std::string why = why_unreadable(file);
    *error = why.empty() ? "is not a file" : why;
    return std::nullopt;
  }
  const std::uintmax_t size = fs::file_size(file, code);
  if (code || size > kMaxFileBytes) {
    *error = code ? code.message() : fmt::format("is {} bytes long: not a camera image", size);
    return std::nullopt;
  }
  std::vector<uint8_t> bytes(size);
  std::ifstream stream(file, std::ios::binary);
  if (!stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size))) {
    const std::string why = why_unreadable(file);
    *error = why.empty() ? "cannot be read; is the disk in order?" : why;
    return std::nullopt;
  }
  if (bytes.empty()) {
    *error = "is empty";
    return std::nullopt;
  }
  if (is_lfs_pointer(bytes)) {
    *error = "is a pointer of Git LFS, not the image: run `git lfs pull` where it was cloned";
    return std::nullopt;
  }
  return bytes;
}

bool looks_like_jpeg(const std::vector<uint8_t>& bytes) {
  return bytes.size() > 2 && bytes[0] == 0xFF && bytes[1] == 0xD8 && bytes[2] == 0xFF;
}

// Whatever its name is: phones' programs call some of them .jpg.
bool is_heic(const std::vector<uint8_t>& bytes) {
  const std::string beginning(bytes.begin(),
                              bytes.begin() + static_cast<ptrdiff_t>(std::min<size_t>(12, bytes.size())));
  const std::string kind = beginning.size() == 12 ? beginning.substr(4) : "";
  return kind == "ftypheic" || kind == "ftypheix" || kind == "ftypmif1" || kind == "ftyphevc";
}

// What is wrong with a file that OpenCV is to decode, or an empty string.
std::string check_header(const std::vector<uint8_t>& bytes) {
  const std::optional<HeaderSize> size = size_in_header(bytes);
  if (!size && is_heic(bytes))
    return "is of the kind HEIC, which is not read: convert it, as with `mogrify -format jpg` of ImageMagick";
  if (!size) return "is corrupt, or not a JPEG, PNG, BMP, TIFF, PGM, PPM or WebP image";
  if (size->width < 1 || size->height < 1 || size->width > kMaxSide || size->height > kMaxSide)
    return fmt::format("has {} x {} pixels: must have 1 to {} a side", size->width, size->height, kMaxSide);
  return {};
}

cv::Mat if_usable(const cv::Mat& pixels, std::string* error) {
  if (pixels.empty() || pixels.depth() == CV_8U || pixels.depth() == CV_16U) return pixels;
  *error = "has pixels that are neither of 8 nor of 16 bits without sign; convert it";
  return {};
}

image_t to_image(cv::Mat pixels, const std::function<GreyRange()>& range) {
  if (pixels.depth() == CV_16U) pixels = to_8_bit(pixels, range());
  return pixels.channels() == 1 ? make_grey_image(0, pixels) : make_rgb_image(0, pixels);
}

// 8 or 16 bits a channel; empty, and why in *error, if it cannot be had.
cv::Mat decode(const std::vector<uint8_t>& bytes, bool colour, std::string* error) {
  *error = check_header(bytes);
  if (!error->empty()) return {};
  cv::Mat pixels;
  try {
    const DecoderMessages are_ours;
    const int wanted = colour ? cv::IMREAD_ANYCOLOR : cv::IMREAD_GRAYSCALE;
    pixels = cv::imdecode(bytes, wanted | cv::IMREAD_ANYDEPTH | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception&) {
    pixels.release();
  }
  if (pixels.empty()) *error = "is corrupt, or not an image";
  if (const int white = white_in_header(bytes); pixels.depth() == CV_8U && white < 255)
    pixels.convertTo(pixels, -1, 255.0 / white);
  return if_usable(pixels, error);
}

cv::Mat decode_page(const fs::path& file, int page, bool colour, std::string* error) {
  std::vector<cv::Mat> pages;
  try {
    const DecoderMessages are_ours;
    const int wanted = colour ? cv::IMREAD_ANYCOLOR : cv::IMREAD_GRAYSCALE;
    cv::imreadmulti(file.string(), pages, page, 1, wanted | cv::IMREAD_ANYDEPTH);
  } catch (const cv::Exception&) {
    pages.clear();
  }
  if (pages.size() == 1 && !pages[0].empty()) return if_usable(pages[0], error);
  *error = "is corrupt, or not an image";
  return {};
}

}  // namespace

GreyRange sample_grey_range(const std::vector<fs::path>& files) {
  GreyHistogram histogram;
  const size_t count = std::min(files.size(), GreyHistogram::kMostImages);
  for (size_t i = 0; i < count; ++i) {
    std::string ignored;
    const auto bytes = read_file(files[i * files.size() / count], &ignored);
    if (bytes) histogram.add(grey_pixels_of_bytes(*bytes));
  }
  return histogram.range();
}

cv::Mat grey_pixels_of_bytes(const std::vector<uint8_t>& bytes) {
  std::string ignored;
  return looks_like_jpeg(bytes) ? cv::Mat() : decode(bytes, /*colour=*/false, &ignored);
}

std::optional<image_t> load_image_file(const fs::path& file, bool colour, const std::function<GreyRange()>& range,
                                       std::string* error) {
  std::optional<std::vector<uint8_t>> bytes = read_file(file, error);
  return bytes ? load_image_bytes(std::move(*bytes), colour, range, error) : std::nullopt;
}

std::optional<image_t> load_image_bytes(std::vector<uint8_t> bytes, bool colour,
                                        const std::function<GreyRange()>& range, std::string* error) {
  if (looks_like_jpeg(bytes)) {
    JpegSize size;
    if (!inspect_jpeg(bytes, &size, error)) return std::nullopt;
    bytes.resize(size.bytes);
    return wrap_jpeg(0, size.width, size.height, std::move(bytes));
  }
  const cv::Mat pixels = decode(bytes, colour, error);
  return pixels.empty() ? std::nullopt : std::optional(to_image(pixels, range));
}

std::optional<image_t> load_tiff_page(const fs::path& file, int page, bool colour,
                                      const std::function<GreyRange()>& range, std::string* error) {
  const cv::Mat pixels = decode_page(file, page, colour, error);
  return pixels.empty() ? std::nullopt : std::optional(to_image(pixels, range));
}

cv::Mat grey_pixels_of_page(const fs::path& file, int page) {
  std::string ignored;
  return decode_page(file, page, /*colour=*/false, &ignored);
}

}  // namespace rumi
