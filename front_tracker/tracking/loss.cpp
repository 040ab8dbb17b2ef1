// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/tracking/loss.h"

#include <fmt/format.h>

#include "base/running/log.h"

namespace rumi::front_tracker {

std::string describe(const Loss& loss, int64_t utime_us) {
  std::string text = fmt::format("lost at {:.2f} s (utime {}) after {} images in submap {}: {} {}, {:.1f} s",
                                 1e-6 * static_cast<double>(loss.utime_us - loss.first_utime_us), loss.utime_us,
                                 loss.frames_before, loss.submap_id, loss.images, loss.images == 1 ? "image" : "images",
                                 1e-6 * static_cast<double>(utime_us - loss.utime_us));
  if (!loss.why.empty()) text += fmt::format(" ({})", loss.why);
  if (loss.posed_afterwards > 0) text += fmt::format(", {} of them with a pose by now", loss.posed_afterwards);
  if (loss.withdrawn > 0)
    text += fmt::format("; the poses of {} images before contradict where it was found: withdrawn", loss.withdrawn);
  return text + "; " + loss.outcome;
}

void LossReport::set_outcome(std::string outcome) {
  if (loss_) loss_->outcome = std::move(outcome);
}

void LossReport::image(int64_t utime_us, bool has_pose, size_t posed_afterwards, size_t withdrawn) {
  if (!loss_) return;
  if (!has_pose) {
    ++loss_->images;
    return;
  }
  loss_->posed_afterwards = static_cast<int>(posed_afterwards);
  loss_->withdrawn = static_cast<int>(withdrawn);
  log_line(loss_->is_hiccup() ? LogLevel::kDebug : LogLevel::kInfo, describe(*loss_, utime_us));
  loss_.reset();
}

void LossReport::end(int64_t last_utime_us) {
  if (!loss_) return;
  loss_->outcome = "not found again until the end";
  log_info("{}", describe(*loss_, last_utime_us));
}

}  // namespace rumi::front_tracker
