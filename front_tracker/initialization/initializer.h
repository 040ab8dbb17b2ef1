// SPDX-License-Identifier: BSD-3-Clause
// Begins a submap: watches frames until two of them, and the frames between, give a structure that can be trusted.
//
// Several frames are kept as references, and their keypoints are followed from frame to frame. Once the motion since a
// reference is more than a rotation, the two views are reconstructed, and the frames between judge the result.
#pragma once

#include <deque>
#include <string>
#include <vector>

#include "base/result.h"
#include "front_tracker/frame/frame.h"
#include "front_tracker/initialization/initial_structure.h"
#include "front_tracker/initialization/initializer_options.h"
#include "front_tracker/matching/reference_tracks.h"

namespace rumi::front_tracker {

class Initializer {
 public:
  Initializer(const Camera& camera, const InitializerOptions& options, const std::vector<double>& octave_scales);

  void clear();
  // Buffers the frame and follows the references into it, without trying to begin. Only its full image is kept,
  // as long as the frame may become a keyframe.
  void buffer(Frame frame);
  // Takes all buffered frames, in order of time.
  std::deque<Frame> take_frames();
  // Buffers the frame and tries to begin with it. Returns an Error if the submap cannot begin yet.
  Result<InitialMap> add(Frame frame);
  // Returns why the last add() failed; empty after clear().
  const std::string& refusal() const { return refusal_; }

 private:
  struct Reference {
    size_t frame = 0;  // index into frames_
    ReferenceTracks tracks;
    int misses = 0;             // frames in a row in which too few of the reference's keypoints were found
    double next_motion_px = 0;  // motion beyond a rotation from which another try is worthwhile
  };
  struct Rival {
    InitialStructure structure;
    double error_px = 0;
    Result<> holds;  // result of its bundle adjustment
  };
  void follow();
  void trim();
  void drop_images();
  Result<InitialMap> begin();
  Result<Reference*> most_promising();
  Result<InitialMap> begin_with(Reference* reference);
  Result<std::vector<Rival>> find_rivals(const FollowedFrames& input, const TwoViewResult& pair,
                                         const std::vector<int>& keypoints) const;
  Result<> check(const Rival& best, const std::vector<Rival>& rivals, double direction_rad) const;

  Camera camera_;
  InitializerOptions options_;
  std::vector<double> scales_;
  std::deque<Frame> frames_;
  std::vector<Reference> references_;  // oldest first
  std::string refusal_;
};

}  // namespace rumi::front_tracker
