// SPDX-License-Identifier: BSD-3-Clause
// The structure that two frames and those between them allow: what Initializer judges and begins a submap with.
#pragma once

#include <deque>
#include <string>
#include <utility>
#include <vector>

#include "front_tracker/frame/frame.h"
#include "front_tracker/initialization/initializer_options.h"
#include "front_tracker/matching/reference_tracks.h"
#include "slam/optimization/bundle_adjustment.h"

namespace rumi::front_tracker {

// A first structure, in the frame of its first view, scaled to a median depth of 1.
struct InitialMap {
  struct View {
    size_t frame = 0;  // index into `frames`
    SE3 cam_from_submap;
    bool keyframe = false;
  };
  struct Point {
    Eigen::Vector3d position;
    std::vector<std::pair<size_t, int>> observations;  // index into `views` (keyframes only), keypoint
  };
  std::vector<Frame> frames;  // all that were buffered, in time order; those without a view have no pose yet
  std::vector<View> views;
  std::vector<Point> points;
};

// Frames from a reference on, in which its keypoints were followed.
struct FollowedFrames {
  const Camera& camera;
  const InitializerOptions& options;
  const std::vector<double>& octave_scales;
  const std::deque<Frame>& frames;  // those before the reference included
  size_t reference = 0;             // index into frames
  const ReferenceTracks& tracks;
};

class InitialStructure {
 public:
  // `pair` is of the reference and the newest frame; its points are at `keypoints` of the reference. `input` must
  // outlive it.
  InitialStructure(const FollowedFrames& input, const TwoViewHypothesis& pair, const std::vector<int>& keypoints);

  // Frames between the two are a check that costs little: a structure that they do not agree with is wrong. False, and
  // refusal() set, if most do not.
  bool add_views_between();
  // Bundle adjustment. False, and refusal() set, if the structure does not hold.
  bool adjust();
  // RMS over all that was matched in the views, each error cut off at what makes an outlier: to compare rivals by.
  double error_px() const;
  // Standard deviation of the direction of the motion between the two, if a keypoint's noise were one pixel at octave
  // 0.
  double direction_sigma_rad() const;
  // Rivals that bundle adjustment made one.
  bool same_as(const InitialStructure& other) const;
  const std::string& refusal() const { return refusal_; }

  // Views and points of the map; its frames are the caller's.
  InitialMap finish() const;

 private:
  struct View {
    size_t frame = 0;  // index into the input's frames
    SE3 cam_from_reference;
    std::vector<int> keypoints;  // per point, the keypoint that is taken for it, or kNone
    std::vector<bool> agrees;    // per point
  };
  std::vector<int> keypoints_in(size_t frame) const;
  View make_view(size_t frame, const SE3& cam_from_reference) const;
  BundleProblem::Observation observation(size_t view, size_t point) const;
  std::optional<SE3> resect_frame(size_t frame, const SE3& neighbour) const;
  // All views and points, without observations.
  BundleProblem as_it_is() const;
  bool solve(const std::vector<size_t>& chosen, int iterations);
  void sort_out();

  const FollowedFrames* input_;
  std::vector<int> reference_keypoints_;  // of the points
  std::vector<Eigen::Vector3d> points_;   // in the reference's frame
  std::vector<View> views_;               // the reference, the newest, those between in order of time
  std::string refusal_;
};

}  // namespace rumi::front_tracker
