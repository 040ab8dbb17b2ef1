// SPDX-License-Identifier: BSD-3-Clause
#include "bus/wire/mask_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "base/files/file_access.h"
#include "bus/wire/image_masks.h"

namespace rumi {
namespace {

constexpr size_t kMostBytes = 64 << 20;
constexpr const char* kExpected = "give a PNG of the images' size, black where it is to be left out";

// Returns the first bytes of the file, at most `most`; empty if it cannot be read.
std::string beginning_of(const std::string& file, size_t most) {
  std::error_code code;
  const std::uintmax_t size = std::filesystem::file_size(file, code);
  std::string bytes(code ? 0 : std::min<std::uintmax_t>(size, most), '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<size_t>(std::max<std::streamsize>(stream.gcount(), 0)));
  return bytes;
}

// An Error if the file is no PNG of this size. `beginning`: the first bytes of the file.
Result<> check_beginning(const std::string& file, const std::string& beginning, const cv::Size& size) {
  if (const std::string why = why_unreadable(file, kExpected); !why.empty()) return Error{why, file};
  std::error_code code;
  if (!std::filesystem::is_regular_file(file, code)) return Error{"is not a file", file, kExpected};
  const cv::Size its = size_of_mask(beginning);
  if (its.empty()) return Error{"is not a PNG", file, kExpected};
  if (its == size) return {};
  return Error{fmt::format("the mask is {} x {} pixels and the images are {} x {}: make it of their size (`rumi mask "
                           "RECORDING -o FILE` writes one that fits)",
                           its.width, its.height, size.width, size.height),
               file};
}

}  // namespace

double share_left_out(const cv::Mat& mask) {
  return mask.empty() ? 0 : 1 - static_cast<double>(cv::countNonZero(mask)) / static_cast<double>(mask.total());
}

Result<> check_mask_file(const std::string& file, const cv::Size& size) {
  return check_beginning(file, beginning_of(file, kMaskHeaderBytes), size);
}

Result<cv::Mat> read_mask_file(const std::string& file, const cv::Size& size) {
  const std::string bytes = beginning_of(file, kMostBytes);
  if (const Result<> checked = check_beginning(file, bytes, size); !checked) return checked.error();
  const Result<cv::Mat> pixels = decode_mask(bytes);
  if (!pixels) return Error{pixels.error().what, file, kExpected};
  return pixels;
}

Result<cv::Mat> read_camera_mask(const std::string& file, const cv::Size& size) {
  const Result<cv::Mat> mask = read_mask_file(file, size);
  if (mask && cv::countNonZero(*mask) == 0)
    return Error{"is black all over: black is left out, and white is the world", file};
  return mask;
}

}  // namespace rumi
