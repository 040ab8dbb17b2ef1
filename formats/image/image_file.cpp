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

// Reads a file's bytes. Errors do not name the file: users may know its image by another name.
Result<std::vector<uint8_t>> read_file(const fs::path& file) {
  const auto unreadable = [&file](const std::string& otherwise) {
    const std::string why = why_unreadable(file);
    return Error{why.empty() ? otherwise : why};
  };
  std::error_code code;
  if (!fs::is_regular_file(file, code)) return unreadable("is not a file");
  const std::uintmax_t size = fs::file_size(file, code);
  if (code) return Error{code.message()};
  if (size > kMaxFileBytes) return Error{fmt::format("is {} bytes long: not a camera image", size)};
  std::vector<uint8_t> bytes(size);
  std::ifstream stream(file, std::ios::binary);
  if (!stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size)))
    return unreadable("cannot be read; is the disk in order?");
  if (bytes.empty()) return Error{"is empty"};
  if (is_lfs_pointer(bytes))
    return Error{"is a pointer of Git LFS, not the image: run `git lfs pull` where it was cloned"};
  return bytes;
}

bool looks_like_jpeg(const std::vector<uint8_t>& bytes) {
  return bytes.size() > 2 && bytes[0] == 0xFF && bytes[1] == 0xD8 && bytes[2] == 0xFF;
}

// True if the bytes are a HEIC file, whatever its name: phones' programs call some HEIC files .jpg.
bool is_heic(const std::vector<uint8_t>& bytes) {
  const std::string beginning(bytes.begin(),
                              bytes.begin() + static_cast<ptrdiff_t>(std::min<size_t>(12, bytes.size())));
  const std::string kind = beginning.size() == 12 ? beginning.substr(4) : "";
  return kind == "ftypheic" || kind == "ftypheix" || kind == "ftypmif1" || kind == "ftyphevc";
}

// Checks a file's header before OpenCV decodes it. An Error if OpenCV could not, or the image is too large.
Result<> check_header(const std::vector<uint8_t>& bytes) {
  const std::optional<HeaderSize> size = size_in_header(bytes);
  if (!size && is_heic(bytes))
    return Error{"is of the kind HEIC, which is not read: convert it, as with `mogrify -format jpg` of ImageMagick"};
  if (!size) return Error{"is corrupt, or not a JPEG, PNG, BMP, TIFF, PGM, PPM or WebP image"};
  if (size->width < 1 || size->height < 1 || size->width > kMaxSide || size->height > kMaxSide)
    return Error{fmt::format("has {} x {} pixels: must have 1 to {} a side", size->width, size->height, kMaxSide)};
  return {};
}

Result<cv::Mat> if_usable(const cv::Mat& pixels) {
  if (pixels.empty()) return Error{"is corrupt, or not an image"};
  if (pixels.depth() == CV_8U || pixels.depth() == CV_16U) return pixels;
  return Error{"has pixels that are neither of 8 nor of 16 bits without sign; convert it"};
}

image_t to_image(cv::Mat pixels, const std::function<GreyRange()>& range) {
  if (pixels.depth() == CV_16U) pixels = to_8_bit(pixels, range());
  return pixels.channels() == 1 ? make_grey_image(0, pixels) : make_rgb_image(0, pixels);
}

// Decodes an image to pixels of 8 or 16 bits a channel. An Error if it is corrupt or has other pixels.
Result<cv::Mat> decode(const std::vector<uint8_t>& bytes, bool colour) {
  if (const Result<> checked = check_header(bytes); !checked) return checked.error();
  cv::Mat pixels;
  try {
    const DecoderMessages are_ours;
    const int wanted = colour ? cv::IMREAD_ANYCOLOR : cv::IMREAD_GRAYSCALE;
    pixels = cv::imdecode(bytes, wanted | cv::IMREAD_ANYDEPTH | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception&) {
    pixels.release();
  }
  if (const int white = white_in_header(bytes); pixels.depth() == CV_8U && white < 255)
    pixels.convertTo(pixels, -1, 255.0 / white);
  return if_usable(pixels);
}

Result<cv::Mat> decode_page(const fs::path& file, int page, bool colour) {
  std::vector<cv::Mat> pages;
  try {
    const DecoderMessages are_ours;
    const int wanted = colour ? cv::IMREAD_ANYCOLOR : cv::IMREAD_GRAYSCALE;
    cv::imreadmulti(file.string(), pages, page, 1, wanted | cv::IMREAD_ANYDEPTH);
  } catch (const cv::Exception&) {
    pages.clear();
  }
  return if_usable(pages.size() == 1 ? pages[0] : cv::Mat());
}

}  // namespace

GreyRange sample_grey_range(const std::vector<fs::path>& files) {
  GreyHistogram histogram;
  const size_t count = std::min(files.size(), GreyHistogram::kMostImages);
  for (size_t i = 0; i < count; ++i)
    if (const Result<std::vector<uint8_t>> bytes = read_file(files[i * files.size() / count]))
      histogram.add(grey_pixels_of_bytes(*bytes));
  return histogram.range();
}

cv::Mat grey_pixels_of_bytes(const std::vector<uint8_t>& bytes) {
  return looks_like_jpeg(bytes) ? cv::Mat() : decode(bytes, /*colour=*/false).value_or(cv::Mat());
}

Result<image_t> load_image_file(const fs::path& file, bool colour, const std::function<GreyRange()>& range) {
  Result<std::vector<uint8_t>> bytes = read_file(file);
  if (!bytes) return bytes.error();
  return load_image_bytes(std::move(*bytes), colour, range);
}

Result<image_t> load_image_bytes(std::vector<uint8_t> bytes, bool colour, const std::function<GreyRange()>& range) {
  if (looks_like_jpeg(bytes)) {
    const Result<JpegSize> size = inspect_jpeg(bytes);
    if (!size) return size.error();
    bytes.resize(size->bytes);
    return wrap_jpeg(0, size->width, size->height, std::move(bytes));
  }
  const Result<cv::Mat> pixels = decode(bytes, colour);
  if (!pixels) return pixels.error();
  return to_image(*pixels, range);
}

Result<image_t> load_tiff_page(const fs::path& file, int page, bool colour, const std::function<GreyRange()>& range) {
  const Result<cv::Mat> pixels = decode_page(file, page, colour);
  if (!pixels) return pixels.error();
  return to_image(*pixels, range);
}

cv::Mat grey_pixels_of_page(const fs::path& file, int page) {
  return decode_page(file, page, /*colour=*/false).value_or(cv::Mat());
}

}  // namespace rumi
