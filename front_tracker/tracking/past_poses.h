// SPDX-License-Identifier: BSD-3-Clause
// Finds poses of frames that were buffered while there was no submap to track them in.
#pragma once

#include <deque>
#include <vector>

#include "front_tracker/frame/front_submap.h"
#include "front_tracker/frame/tracking_options.h"

namespace rumi::front_tracker {

class PastPoses {
 public:
  explicit PastPoses(const TrackingOptions& options) : options_(options) {}

  // Tracks backwards the frames before one that was found again, each from the one after it, until one fails. Adds them
  // to the submap and returns them in order of time: at most 60, because the camera does not wait.
  std::vector<Frame> track_back(const Frame& found, std::deque<Frame> frames, FrontSubmap* submap) const;

  // Tracks those of `frames` that are not `posed`, each from a neighbour that is, and adds them to the submap. `frames`
  // came before the submap began, in order of time.
  void fill_in(std::vector<Frame>* frames, std::vector<bool>* posed, FrontSubmap* submap) const;

  // Returns the certainty of a frame whose pose does not come from its matches; an unknown one if too few landmarks are
  // found in it, or they leave the pose too uncertain.
  PoseCertainty certainty_at(const Frame& posed, const FrontSubmap& submap) const;

 private:
  bool track_from(const Frame& neighbour, const std::vector<const Landmark*>& landmarks, double max_image_px,
                  const FrontSubmap& submap, Frame* frame) const;

  TrackingOptions options_;
};

}  // namespace rumi::front_tracker
