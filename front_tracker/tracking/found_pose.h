// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "front_tracker/frame/frame.h"

namespace rumi::front_tracker {

inline constexpr int kFewestLandmarks = 10;  // that make a pose

// What became of looking for a frame's pose.
struct FoundPose {
  Frame frame = {};  // with its pose and its matches, if it was found
  // Of the image since the last frame, if it was tracked from that one: median, of the image's width.
  std::optional<double> motion = {};
  std::vector<int> visible = {};  // landmarks that were looked for by their descriptors and should be in view
  std::string why_not = {};       // empty: it was found

  bool found() const { return why_not.empty(); }
};

}  // namespace rumi::front_tracker
