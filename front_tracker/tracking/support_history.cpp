// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/tracking/support_history.h"

#include <algorithm>

#include "slam/map/tracking_state.h"

namespace rumi::front_tracker {
namespace {

// A slip may begin this long before the loss that reveals it.
constexpr int64_t kMayBeWrong_us = 4'000'000;

}  // namespace

void SupportHistory::add(const Frame& frame) {
  supports_.push_back({frame.utime_us, frame.matches(), frame.certainty.log_scale_variance});
  while (frame.utime_us - supports_.front().utime_us > kMayBeWrong_us ||
         static_cast<int>(supports_.size()) > kMostRetoldFrames)
    supports_.pop_front();
}

bool SupportHistory::scale_drifts(const Frame& frame, double max_drift) const {
  constexpr int64_t kOver_us = 1'000'000;
  if (supports_.empty()) return false;
  const auto then = std::find_if(supports_.begin(), supports_.end(),
                                 [&](const Support& s) { return frame.utime_us - s.utime_us <= kOver_us; });
  const double before = then == supports_.end() ? supports_.back().log_scale_variance : then->log_scale_variance;
  return frame.certainty.log_scale_variance - before > max_drift * max_drift;
}

std::optional<int64_t> SupportHistory::begin_us() const {
  return supports_.empty() ? std::nullopt : std::optional(supports_.front().utime_us);
}

int64_t SupportHistory::weak_since_us() const {
  auto first = std::min_element(supports_.begin(), supports_.end(),
                                [](const Support& a, const Support& b) { return a.inliers < b.inliers; });
  const int weak = 2 * first->inliers;
  while (first != supports_.begin() && std::prev(first)->inliers < weak) --first;
  return first->utime_us;
}

void SupportHistory::forget_from(int64_t utime_us) {
  while (!supports_.empty() && supports_.back().utime_us >= utime_us) supports_.pop_back();
}

}  // namespace rumi::front_tracker
