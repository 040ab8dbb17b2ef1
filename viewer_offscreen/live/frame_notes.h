// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lcmtypes/rumi/track_t.hpp"
#include "viewer_offscreen/scene/timeline.h"

namespace rumi::viewer_offscreen {

// What became of the frames, as front_tracker told it.
class FrameNotes {
 public:
  // most: how many of the latest frames are kept.
  explicit FrameNotes(size_t most = SIZE_MAX) : most_(most) {}
  // A frame that is told of again keeps what was said first, unless its pose was withdrawn.
  void take(const track_t& track);
  const std::vector<FrameNote>& by_time() const { return notes_; }

 private:
  size_t most_;
  std::vector<FrameNote> notes_;
};

}  // namespace rumi::viewer_offscreen
