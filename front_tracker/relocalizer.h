// SPDX-License-Identifier: BSD-3-Clause
// Finds the camera again in submaps made before: retrieval over the keyframes' descriptors, matching, resection.
#pragma once

#include <vector>

#include "front_tracker/front_submap.h"
#include "front_tracker/options.h"
#include "slam/features/keyframe_index.h"

namespace rumi {

class Relocalizer {
 public:
  Relocalizer(const Camera& camera, const TrackingOptions& options) : camera_(camera), options_(options) {}

  // Forgets keyframes that were culled from the submap since.
  void add_keyframe(size_t submap_index, const Submap& submap, const Keyframe& keyframe);

  struct Candidate {
    size_t submap_index = 0;
    int keyframe_id = kNone;
  };
  // Keyframes that look like the frame, best first.
  std::vector<Candidate> candidates(const Frame& frame) const;
  size_t size() const { return index_.size(); }

  // Matches the frame against the landmarks of one keyframe and its neighbours. On success the frame has a pose in that
  // submap and its matches; else it is as before.
  bool relocalize(const FrontSubmap& submap, int keyframe_id, Frame* frame) const;

 private:
  Camera camera_;
  TrackingOptions options_;
  KeyframeIndex index_;
};

}  // namespace rumi
