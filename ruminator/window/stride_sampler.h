// SPDX-License-Identifier: BSD-3-Clause
// Samples tracked frames. Every keyframe becomes a sample, because the front submap has landmarks for it, and a merge
// needs frames that both submaps have. Between keyframes, one frame per stride is enough for neighbours to match; if
// the camera has turned, the next sample comes sooner.
#pragma once

#include <cstdlib>
#include <deque>
#include <numbers>

#include "ruminator/window/rumination_window.h"

namespace rumi::ruminator {

class StrideSampler {
 public:
  explicit StrideSampler(int stride) : stride_(stride) {}

  // Adds the next frame, which must be tracked in the same submap as the previous ones. A keyframe replaces a sample up
  // to half a stride before it, if that is no keyframe and not needed as a bridge. The first sample is never replaced:
  // after a loss it is the one nearest to the gap. A frame without an image is only counted.
  void add(const Sample& frame, bool has_image) {
    ++since_last_;
    if (!has_image) return;
    if (!samples_.empty()) {
      const bool is_due = since_last_ >= stride_ || has_turned(samples_.back(), frame);
      if (!frame.is_keyframe && !is_due) return;
      if (frame.is_keyframe && can_replace_last(frame)) samples_.pop_back();
    }
    samples_.push_back(frame);
    since_last_ = 0;
  }
  // Keeps the newest `count` samples, and of the older ones those among the newest `keyframes` keyframes. Keyframes
  // need no samples between them: front_tracker found enough in common between successive ones.
  void keep_newest(int count, int keyframes) {
    std::deque<Sample> kept;
    int samples_seen = 0, keyframes_seen = 0;
    for (auto sample = samples_.rbegin(); sample != samples_.rend(); ++sample) {
      keyframes_seen += sample->is_keyframe;
      if (++samples_seen <= count || (sample->is_keyframe && keyframes_seen <= keyframes)) kept.push_front(*sample);
    }
    samples_.swap(kept);
  }
  // Adds the newest frame even if no sample is due.
  void add_last(const Sample& frame) {
    if (samples_.empty() || samples_.back().utime_us < frame.utime_us) samples_.push_back(frame);
  }
  // Removes the sample of that time. Returns false if there is none.
  bool take(int64_t utime_us) {
    return std::erase_if(samples_, [utime_us](const Sample& s) { return s.utime_us == utime_us; }) > 0;
  }
  // Says that what was the submap `from` is the submap `to` from now on.
  void rename(int32_t from, int32_t to) {
    for (Sample& sample : samples_)
      if (sample.submap_id == from) sample.submap_id = to;
  }
  void clear() {
    samples_.clear();
    since_last_ = 0;
  }
  const std::deque<Sample>& samples() const { return samples_; }
  int keyframes() const {
    int count = 0;
    for (const Sample& sample : samples_) count += sample.is_keyframe;
    return count;
  }

 private:
  bool has_turned(const Sample& from, const Sample& to) const {
    constexpr double kMaxTurnRad = 5 * std::numbers::pi / 180.0;  // at a low rate a stride may turn farther
    return (to.cam_from_submap * from.cam_from_submap.inverse()).angle_rad() > kMaxTurnRad;
  }
  bool can_replace_last(const Sample& frame) const {
    if (samples_.size() < 2 || samples_.back().is_keyframe || since_last_ > stride_ / 2) return false;
    return !has_turned(samples_[samples_.size() - 2], frame);
  }

  int stride_;
  int since_last_ = 0;  // frames since the last sample
  std::deque<Sample> samples_;
};

}  // namespace rumi::ruminator
