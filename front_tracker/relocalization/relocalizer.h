// SPDX-License-Identifier: BSD-3-Clause
// Finds the camera again in submaps made earlier: retrieves similar keyframes by their descriptors, matches, and
// resects.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "front_tracker/frame/frame.h"
#include "front_tracker/frame/tracking_options.h"
#include "slam/features/keyframe_index.h"
#include "slam/optimization/pose_optimizer.h"

namespace rumi::front_tracker {

class Relocalizer {
 public:
  // `octave_scales`: Pyramid::scales() of the frames' keypoints.
  Relocalizer(const Camera& camera, const TrackingOptions& options, const std::vector<double>& octave_scales)
      : camera_(camera), options_(options), scales_(octave_scales) {}

  // Adds a keyframe, or replaces it. Also forgets keyframes that have been culled from the submap.
  void add_keyframe(size_t submap_index, const Submap& submap, const Keyframe& keyframe);
  void forget_keyframe(size_t submap_index, int keyframe_id);
  void forget_submap(size_t submap_index);

  struct Candidate {
    size_t submap_index = 0;
    int keyframe_id = kNone;
  };
  // Returns the keyframes that look like the frame, best first.
  std::vector<Candidate> candidates(const Frame& frame) const;
  size_t size() const { return index_.size(); }

  // Matches the frame against the landmarks of one keyframe and its neighbours. Returns the frame with its matches and
  // its pose in that submap; nullopt if the camera is not there.
  std::optional<Frame> relocalize(const Submap& submap, int keyframe_id, const Frame& frame) const;

  // True if the frame sees the same things as this keyframe, but from another place than its pose says. Then the submap
  // is torn between the keyframe and the place at which the frame was found.
  bool contradicts(const Submap& submap, int keyframe_id, const Frame& frame) const;

 private:
  bool is_worth_comparing(const Submap& submap, const Keyframe& keyframe, const Frame& frame) const;
  std::optional<size_t> match_neighbourhood(const Submap& submap, int keyframe_id, Frame* found) const;
  bool is_proven(const Submap& submap, size_t in_view, Frame* found) const;

  Camera camera_;
  TrackingOptions options_;
  std::vector<double> scales_;
  KeyframeIndex index_;
};

}  // namespace rumi::front_tracker
