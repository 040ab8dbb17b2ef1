// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/web/live_image.h"

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "bus/wire/image_codec.h"
#include "bus/wire/jpeg_decoder.h"
#include "bus/wire/jpeg_image.h"

namespace rumi::tool {
namespace {

constexpr int kWidth = 480;  // pixels, at most
constexpr int kQuality = 75;

// Returns the image reduced to about the size in which it is shown; empty if it cannot be decoded. front_tracker counts
// such images.
cv::Mat decode_small(const image_t& image) {
  if (!check_image(image)) return {};
  int reduction = 1;
  while (reduction < 8 && image.width / (2 * reduction) >= kWidth) reduction *= 2;
  const bool is_jpeg = image.pixelformat == image_t::PIXEL_FORMAT_MJPEG;
  cv::Mat pixels = (is_jpeg ? decode_jpeg(image.data, false, reduction) : decode_bgr(image)).value_or(cv::Mat());
  if (pixels.cols <= kWidth) return pixels;
  cv::Mat small;
  const int height = static_cast<int>(std::lround(double(kWidth) * pixels.rows / pixels.cols));
  cv::resize(pixels, small, {kWidth, std::max(1, height)}, 0, 0, cv::INTER_AREA);
  return small;
}

}  // namespace

LiveImage::LiveImage(Bus& bus) {
  // While nobody looks, images are dropped and not decoded.
  bus.subscribe_raw(channels::kCamera, {.capacity = 1, .drop = DropPolicy::kDropOldest},
                    [this](std::span<const uint8_t> data) {
                      if (!watched_) return true;
                      image_t image;
                      if (!Bus::decode(data, &image) || !plausible_utime(image.utime)) return false;
                      newest_ = std::move(image);
                      is_new_ = true;
                      return true;
                    });
}

std::optional<int64_t> LiveImage::utime_us() const { return newest_ ? std::optional(newest_->utime) : std::nullopt; }

std::shared_ptr<const std::string> LiveImage::jpeg(int64_t now_us) {
  if (!is_new_ || !is_due(now_us, made_us_, kPeriodUs)) return jpeg_;
  is_new_ = false;
  made_us_ = now_us;
  const cv::Mat pixels = decode_small(*newest_);
  if (pixels.empty()) return jpeg_ = nullptr;
  const image_t small = make_jpeg_image(newest_->utime, pixels, kQuality);
  return jpeg_ = std::make_shared<const std::string>(small.data.begin(), small.data.end());
}

}  // namespace rumi::tool
