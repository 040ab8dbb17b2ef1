// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/atlas/still_mask.h"

#include <fmt/format.h>

#include <opencv2/core/mat.hpp>
#include <tuple>

#include "bus/transport/bus.h"
#include "bus/wire/image_masks.h"
#include "slam/geometry/max_side.h"

namespace rumi::map_server {
namespace {

constexpr size_t kMostBytes = 1'000'000;  // largest size of a PNG; an image of two colours needs far less
constexpr int kLeastSide = 16;

bool is_side(int side) { return side >= kLeastSide && side <= kMaxSide; }

// Reads the size from the header before decoding, because a small PNG may decode to gigabytes.
Result<> check_png(const StillMask& mask) {
  if (mask.png.size() > kMostBytes)
    return Error{fmt::format("its PNG has {} bytes; {} are allowed", mask.png.size(), kMostBytes)};
  const cv::Size size = size_of_mask(mask.png);
  if (size.empty()) return Error{"it is no PNG"};
  if (size != cv::Size(mask.width, mask.height))
    return Error{
        fmt::format("its PNG is {} x {} pixels, not {} x {}", size.width, size.height, mask.width, mask.height)};
  if (const Result<cv::Mat> decoded = decode_mask(mask.png); !decoded) return decoded.error();
  return {};
}

}  // namespace

bool StillMask::is_same(const StillMask& other) const {
  return std::tie(session, width, height, left_out, png) ==
         std::tie(other.session, other.width, other.height, other.left_out, other.png);
}

bool StillMask::is_newer(const StillMask& other) const {
  return std::tie(session, utime_us) > std::tie(other.session, other.utime_us);
}

Result<> check(int64_t stream, const StillMask& mask) {
  if (stream <= 0) return Error{fmt::format("stream {} is none", stream)};
  if (!plausible_utime(mask.utime_us)) return Error{fmt::format("{} is no time", mask.utime_us)};
  if (!is_side(mask.width) || !is_side(mask.height))
    return Error{fmt::format("{} x {} pixels is no size of an image", mask.width, mask.height)};
  if (!(mask.left_out >= 0 && mask.left_out <= 1))
    return Error{fmt::format("{} is no share of an image", mask.left_out)};
  if (mask.png.empty() != (mask.left_out == 0))
    return Error{fmt::format("it leaves out {} of the image, by a PNG of {} bytes", mask.left_out, mask.png.size())};
  if (mask.png.empty()) return {};
  return check_png(mask);
}

}  // namespace rumi::map_server
