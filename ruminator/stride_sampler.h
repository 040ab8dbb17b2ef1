// SPDX-License-Identifier: BSD-3-Clause
// Every stride-th frame, with a preference for keyframes: they are the frames that the front submap has landmarks for,
// and the merge needs frames that both submaps share.
#pragma once

#include <deque>

#include "ruminator/rumination_window.h"

namespace rumi {

class StrideSampler {
 public:
  explicit StrideSampler(int stride) : stride_(stride) {}

  // The next frame. A keyframe is taken up to half a stride early, or in place of the sample up to half a stride before
  // it if that is no keyframe. A frame without image is counted only.
  void add(const Sample& frame, bool has_image) {
    ++since_last_;
    if (!has_image) return;
    const bool replaces =
        frame.is_keyframe && !samples_.empty() && !samples_.back().is_keyframe && since_last_ <= stride_ / 2;
    const bool is_next = samples_.empty() || since_last_ >= (frame.is_keyframe ? (stride_ + 1) / 2 : stride_);
    if (!replaces && !is_next) return;
    if (replaces) samples_.pop_back();
    samples_.push_back(frame);
    since_last_ = 0;
  }
  void keep_newest(int count) {
    while (static_cast<int>(samples_.size()) > count) samples_.pop_front();
  }
  void clear() { *this = StrideSampler(stride_); }
  const std::deque<Sample>& samples() const { return samples_; }

 private:
  int stride_;
  int since_last_ = 0;  // frames
  std::deque<Sample> samples_;
};

}  // namespace rumi
