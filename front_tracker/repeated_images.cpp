// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/repeated_images.h"

#include <fmt/format.h>

#include <opencv2/core.hpp>

#include "base/running/log.h"

namespace rumi::front_tracker {
namespace {

constexpr double kMostNoise = 1;       // largest difference in grey levels that encoding an image again may leave
constexpr int64_t kMostDoubled = 2;    // repeated images in a row that are kDoubled
constexpr int64_t kWorthTelling = 10;  // repeated images in a row that are worth a line in the log

}  // namespace

void RepeatedImages::begin_session() {
  last_ = cv::Mat();
  first_utime_us_ = INT64_MIN;
  row_ = {};
}

RepeatedImages::Kind RepeatedImages::take(int64_t utime_us, const cv::Mat& grey) {
  if (first_utime_us_ == INT64_MIN) first_utime_us_ = utime_us;
  const bool is_same = last_.size() == grey.size() && cv::norm(last_, grey, cv::NORM_INF) <= kMostNoise;
  if (!is_same) {
    if (row_.images >= kWorthTelling) log_warning("{} images in a row were the same", row_.images);
    last_ = grey.clone();
    row_ = {};
    return Kind::kNew;
  }
  if (row_.images++ == 0) row_.begin_s = 1e-6 * static_cast<double>(utime_us - first_utime_us_);
  if (row_.images > longest_.images) longest_ = row_;
  const Kind kind = row_.images <= kMostDoubled ? Kind::kDoubled : Kind::kStill;
  ++(kind == Kind::kDoubled ? doubled_ : still_);
  tell(kind);
  return kind;
}

void RepeatedImages::tell(Kind kind) const {
  if (row_.images == kWorthTelling)
    log_warning(
        "{} images in a row, from {:.2f} s on, are the same as the one before them: the camera or the recorder stands "
        "still; they get no pose",
        row_.images, row_.begin_s);
  else if (kind == Kind::kDoubled && doubled_ == 1)
    log_info(
        "the image at {:.2f} s is the same as the one before it: its pose follows from the motion before it (further "
        "ones like it are only counted)",
        row_.begin_s);
}

std::string RepeatedImages::text() const {
  if (still_ == 0) return {};
  return fmt::format("{} images are the same as the one before; the longest row: {} from {:.2f} s on", still_,
                     longest_.images, longest_.begin_s);
}

}  // namespace rumi::front_tracker
