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

// Nothing of what is no file.
std::string beginning_of(const std::string& file, size_t most) {
  std::error_code code;
  const std::uintmax_t size = std::filesystem::file_size(file, code);
  std::string bytes(code ? 0 : std::min<std::uintmax_t>(size, most), '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<size_t>(std::max<std::streamsize>(stream.gcount(), 0)));
  return bytes;
}

// Of a file of which these bytes were read.
std::string why_unfit(const std::string& file, const std::string& bytes, const cv::Size& size) {
  if (const std::string why = why_unreadable(file, kExpected); !why.empty()) return fmt::format("{}: {}", file, why);
  std::error_code code;
  if (!std::filesystem::is_regular_file(file, code)) return fmt::format("{}: is not a file; {}", file, kExpected);
  const cv::Size its = size_of_mask(bytes);
  if (its.empty()) return fmt::format("{}: is not a PNG; {}", file, kExpected);
  if (its == size) return {};
  return fmt::format(
      "{}: the mask is {} x {} pixels and the images are {} x {}: make it of their size (`rumi mask RECORDING -o FILE` "
      "writes one that fits)",
      file, its.width, its.height, size.width, size.height);
}

}  // namespace

double MaskFile::left_out() const {
  return pixels.empty() ? 0 : 1 - static_cast<double>(cv::countNonZero(pixels)) / static_cast<double>(pixels.total());
}

std::string why_unfit(const std::string& file, const cv::Size& size) {
  return why_unfit(file, beginning_of(file, kMaskHeaderBytes), size);
}

MaskFile read_mask_file(const std::string& file, const cv::Size& size) {
  MaskFile mask;
  const std::string bytes = beginning_of(file, kMostBytes);
  mask.error = why_unfit(file, bytes, size);
  if (!mask.ok()) return mask;
  std::string why;
  mask.pixels = decode_mask(bytes, &why);
  if (mask.pixels.empty()) mask.error = fmt::format("{}: {}; {}", file, why, kExpected);
  return mask;
}

MaskFile read_camera_mask(const std::string& file, const cv::Size& size) {
  MaskFile mask = read_mask_file(file, size);
  if (mask.ok() && cv::countNonZero(mask.pixels) == 0)
    mask.error = fmt::format("{}: is black all over: black is left out, and white is the world", file);
  return mask;
}

}  // namespace rumi
