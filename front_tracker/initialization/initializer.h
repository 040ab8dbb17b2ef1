// SPDX-License-Identifier: BSD-3-Clause
// Begins a submap: watches frames until two of them, and the frames between, give a structure that can be trusted.
//
// Several frames are kept as references, and their keypoints are followed from frame to frame. Once the motion since a
// reference is more than a rotation, the two views are reconstructed, and the frames between judge the result.
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "front_tracker/frame/frame.h"
#include "front_tracker/initialization/initial_structure.h"
#include "front_tracker/initialization/initializer_options.h"
#include "front_tracker/matching/reference_tracks.h"

namespace rumi::front_tracker {

class Initializer {
 public:
  Initializer(const Camera& camera, const InitializerOptions& options, const std::vector<double>& octave_scales);

  void clear();
  // Buffers the frame and follows the references into it, without trying to begin. Of its pyramid only the full image
  // is kept, as long as the frame may become a keyframe.
  void buffer(Frame frame);
  // Takes all buffered frames, in order of time.
  std::deque<Frame> take_frames();
  // Buffers the frame and tries to begin with it.
  std::optional<InitialMap> add(Frame frame);
  // Why the last try failed, for the log.
  const std::string& refusal() const { return refusal_; }

 private:
  struct Reference {
    size_t frame = 0;  // index into frames_
    ReferenceTracks tracks;
    int misses = 0;             // frames in a row in which too little of it was found
    double next_motion_px = 0;  // from which another try is worth its while
  };
  struct Rival {
    InitialStructure structure;
    double error_px = 0;
    bool holds = false;
  };
  void follow();
  void trim();
  void drop_images();
  Reference* most_promising();
  std::optional<InitialMap> begin_with(Reference* reference);
  std::vector<Rival> find_rivals(const FollowedFrames& input, const TwoViewResult& pair,
                                 const std::vector<int>& keypoints);
  std::string objection(const Rival& best, const std::vector<Rival>& rivals, double direction_rad) const;

  Camera camera_;
  InitializerOptions options_;
  std::vector<double> scales_;
  std::deque<Frame> frames_;
  std::vector<Reference> references_;  // oldest first
  std::string refusal_;
};

}  // namespace rumi::front_tracker
