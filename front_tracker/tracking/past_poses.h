// SPDX-License-Identifier: BSD-3-Clause
// Poses of frames that were buffered while there was nothing to track them in.
#pragma once

#include <deque>
#include <vector>

#include "front_tracker/frame/front_submap.h"
#include "front_tracker/frame/tracking_options.h"

namespace rumi::front_tracker {

class PastPoses {
 public:
  explicit PastPoses(const TrackingOptions& options) : options_(options) {}

  // Frames before one that was found again, as far back as each can be tracked from the one after it, at most 60: the
  // camera does not wait. They are added to the submap. Returned in order of time.
  std::vector<Frame> track_back(const Frame& found, std::deque<Frame> frames, FrontSubmap* submap) const;

  // Frames from before the submap stood, in order of time. Those that are not `posed` are tracked from the nearest that
  // is, and added to the submap.
  void fill_in(std::vector<Frame>* frames, std::vector<bool>* posed, FrontSubmap* submap) const;

  // Of a frame whose pose does not come from what it is matched to. Nothing is known where little is found.
  PoseCertainty certainty_at(const Frame& posed, const FrontSubmap& submap) const;

 private:
  bool track_from(const Frame& neighbour, const std::vector<const Landmark*>& landmarks, double max_image_px,
                  const FrontSubmap& submap, Frame* frame) const;

  TrackingOptions options_;
};

}  // namespace rumi::front_tracker
