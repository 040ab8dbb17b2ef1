// SPDX-License-Identifier: BSD-3-Clause
// Finds the camera again in submaps made before: retrieval over the keyframes' descriptors, matching, resection.
#pragma once

#include <utility>
#include <vector>

#include "front_tracker/frame/frame.h"
#include "front_tracker/frame/tracking_options.h"
#include "slam/features/keyframe_index.h"
#include "slam/optimization/pose_optimizer.h"

namespace rumi::front_tracker {

class Relocalizer {
 public:
  // octave_scales: size of a pixel per octave, see OrbExtractor.
  Relocalizer(const Camera& camera, const TrackingOptions& options, const std::vector<double>& octave_scales)
      : camera_(camera), options_(options), scales_(octave_scales) {}

  // Forgets keyframes that were culled from the submap since.
  void add_keyframe(size_t submap_index, const Submap& submap, const Keyframe& keyframe);
  void forget_submap(size_t submap_index);

  struct Candidate {
    size_t submap_index = 0;
    int keyframe_id = kNone;
  };
  // Keyframes that look like the frame, best first.
  std::vector<Candidate> candidates(const Frame& frame) const;
  size_t size() const { return index_.size(); }

  // Matches the frame against the landmarks of one keyframe and its neighbours. On success the frame has a pose in that
  // submap and its matches; else it is as before.
  bool relocalize(const Submap& submap, int keyframe_id, Frame* frame) const;

  // Does the frame see what this keyframe sees, but from elsewhere than its own pose says? So it is where a submap is
  // torn between the keyframe and the place where the frame was found.
  bool contradicts(const Submap& submap, int keyframe_id, const Frame& frame) const;

 private:
  bool is_worth_comparing(const Submap& submap, const Keyframe& keyframe, const Frame& frame) const;

  Camera camera_;
  TrackingOptions options_;
  std::vector<double> scales_;
  KeyframeIndex index_;
};

}  // namespace rumi::front_tracker
