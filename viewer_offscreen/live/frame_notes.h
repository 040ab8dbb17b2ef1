// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lcmtypes/rumi/track_t.hpp"
#include "viewer_offscreen/scene/timeline.h"

namespace rumi::viewer_offscreen {

// Keeps what front_tracker reported on the frames.
class FrameNotes {
 public:
  // `most`: how many of the latest frames are kept, about.
  explicit FrameNotes(size_t most = SIZE_MAX) : most_(most) {}
  // If a frame is reported twice, the first report counts, unless the second withdraws its pose.
  void take(const track_t& track);
  const std::vector<FrameNote>& by_time() const { return notes_; }

 private:
  size_t most_;
  std::vector<FrameNote> notes_;
};

}  // namespace rumi::viewer_offscreen
