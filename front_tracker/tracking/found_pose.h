// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "front_tracker/frame/frame.h"

namespace rumi::front_tracker {

inline constexpr int kFewestLandmarks = 10;  // inliers that a pose needs, at least

// The result of the search for a frame's pose.
struct FoundPose {
  Frame frame = {};  // has its pose and its matches if the pose was found
  // The median motion of the image since the last frame, as a share of its width; nullopt if the frame was not tracked
  // from the last frame.
  std::optional<double> motion = {};
  std::vector<int> visible = {};  // landmarks that were looked for by descriptors and should be in view
  std::string why_not = {};       // why the pose was not found; empty if it was

  bool found() const { return why_not.empty(); }
};

}  // namespace rumi::front_tracker
