// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/mask_publisher.h"

#include <cmath>

#include "base/running/due.h"
#include "base/running/log.h"
#include "bus/wire/image_masks.h"
#include "lcmtypes/rumi/mask_t.hpp"

namespace rumi::front_tracker {
namespace {

constexpr int64_t kPeriodUs = 1'000'000;

}  // namespace

void MaskPublisher::publish(const Tracker& tracker, int64_t utime_us, int64_t now_us) {
  if (tracker.session() != session_) {
    session_ = tracker.session();
    published_ = cv::Mat();
    told_ = 0;
  }
  const ImageMask& mask = tracker.still_mask();
  const bool is_new = mask.pixels().data != published_.data;
  if (!is_new && (mask.is_everything() || !is_due(now_us, published_us_, kPeriodUs))) return;
  published_ = mask.pixels();
  published_us_ = now_us;
  mask_t message;
  message.utime = utime_us;
  message.stream = tracker.stream();
  message.session = session_;
  message.width = tracker.camera().width;
  message.height = tracker.camera().height;
  message.left_out = mask.left_out();
  if (!mask.is_everything()) {
    const std::string png = encode_mask(mask.pixels());
    message.png.assign(png.begin(), png.end());
  }
  message.size = static_cast<int32_t>(message.png.size());
  bus_.publish(channels::kMask, message);
  if (is_new) tell(message.left_out);
}

void MaskPublisher::tell(double left_out) {
  constexpr double kWorthTelling = 0.03;  // least change of the share left out that is worth a line in the log
  if (std::abs(left_out - told_) < kWorthTelling && (told_ > 0) == (left_out > 0)) return;
  told_ = left_out;
  if (left_out > 0)
    log_info("{:.0f} % of the image never moves (a bonnet, a caption, a rim?): left out", 100 * left_out);
  else
    log_info("what seemed never to move in the image does move: nothing is left out any more");
}

}  // namespace rumi::front_tracker
