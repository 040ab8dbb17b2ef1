// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/tracking/loss_history.h"

#include <algorithm>

#include "slam/map/tracking_state.h"

namespace rumi::front_tracker {
namespace {

// How long before a loss a slip may have begun.
constexpr int64_t kMayBeWrong_us = 4'000'000;

}  // namespace

void LossHistory::add(const Frame& frame) {
  supports_.push_back({frame.utime_us, frame.matches(), frame.certainty.log_scale_variance});
  while (frame.utime_us - supports_.front().utime_us > kMayBeWrong_us ||
         static_cast<int>(supports_.size()) > kMostRetoldFrames)
    supports_.pop_front();
}

bool LossHistory::scale_drifts(const Frame& frame, double max_drift) const {
  constexpr int64_t kOver_us = 1'000'000;
  if (supports_.empty()) return false;
  const auto then = std::find_if(supports_.begin(), supports_.end(),
                                 [&](const Support& s) { return frame.utime_us - s.utime_us <= kOver_us; });
  const double before = then == supports_.end() ? supports_.back().log_scale_variance : then->log_scale_variance;
  return frame.certainty.log_scale_variance - before > max_drift * max_drift;
}

std::vector<int64_t> LossHistory::withdraw_slip(const Relocalizer& relocalizer, const Frame& found,
                                                FrontSubmap* submap) {
  const Submap& map = submap->map;
  if (!is_torn(relocalizer, map, found)) return {};
  const auto first = slip_begins();
  const int64_t first_us = first->utime_us;
  if (map.keyframe(found.reference_keyframe)->utime_us >= first_us ||
      map.keyframes.begin()->second.utime_us >= first_us)
    return {};
  std::vector<int64_t> withdrawn;
  for (auto frame = map.frames.lower_bound(first_us); frame != map.frames.end(); ++frame)
    withdrawn.push_back(frame->first);
  submap->cut_end(first_us);
  supports_.erase(first, supports_.end());
  return withdrawn;
}

// Do the newest keyframes before the loss contradict the place where the frame was found?
bool LossHistory::is_torn(const Relocalizer& relocalizer, const Submap& map, const Frame& found) const {
  constexpr int kCompared = 3;
  if (supports_.empty()) return false;
  auto kf = map.keyframes.rbegin();
  for (int i = 0; i < kCompared && kf != map.keyframes.rend(); ++i, ++kf)
    if (kf->second.utime_us >= supports_.front().utime_us && relocalizer.contradicts(map, kf->first, found))
      return true;
  return false;
}

// With the weakest frame, or one just before it that is hardly stronger.
LossHistory::Supports::const_iterator LossHistory::slip_begins() const {
  auto first = std::min_element(supports_.begin(), supports_.end(),
                                [](const Support& a, const Support& b) { return a.inliers < b.inliers; });
  const int weak = 2 * first->inliers;
  while (first != supports_.begin() && std::prev(first)->inliers < weak) --first;
  return first;
}

}  // namespace rumi::front_tracker
