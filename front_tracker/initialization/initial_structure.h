// SPDX-License-Identifier: BSD-3-Clause
// The structure of two frames and the frames between them, with which Initializer begins a submap.
#pragma once

#include <deque>
#include <utility>
#include <vector>

#include "base/result.h"
#include "front_tracker/frame/frame.h"
#include "front_tracker/initialization/initializer_options.h"
#include "front_tracker/matching/reference_tracks.h"
#include "slam/optimization/bundle_adjustment.h"

namespace rumi::front_tracker {

// The first structure of a submap, in the coordinate system of its first view, scaled to a median depth of 1.
struct InitialMap {
  struct View {
    size_t frame = 0;  // index into `frames`
    SE3 cam_from_submap;
    bool keyframe = false;
  };
  struct Point {
    Eigen::Vector3d position;
    std::vector<std::pair<size_t, int>> observations;  // index into `views` (keyframes only), and keypoint
  };
  std::vector<Frame> frames;  // all buffered frames in order of time; those without a view have no pose yet
  std::vector<View> views;
  std::vector<Point> points;
};

// The buffered frames, and a reference whose keypoints were followed through the frames after it.
struct FollowedFrames {
  const Camera& camera;
  const InitializerOptions& options;
  const std::vector<double>& octave_scales;
  const std::deque<Frame>& frames;  // includes those before the reference
  size_t reference = 0;             // index into frames
  const ReferenceTracks& tracks;
};

class InitialStructure {
 public:
  // `pair` was found from the reference and the newest frame; keypoints[i] is the keypoint of its point i in the
  // reference. `input` must outlive the structure.
  InitialStructure(const FollowedFrames& input, const TwoViewHypothesis& pair, const std::vector<int>& keypoints);

  // Adds frames between the two, which check the structure at little cost. Returns an Error if most of them do not
  // agree: then the structure is wrong.
  Result<> add_views_between();
  // Adjusts the structure by bundle adjustment. Returns an Error if that fails or leaves too few points.
  Result<> adjust();
  // Returns the RMS error of all matches in the views, for a comparison of rival structures. Each error counts no more
  // than the smallest one of an outlier.
  double error_px() const;
  // Returns the standard deviation of the direction of motion between the two frames, if the noise of a keypoint at
  // octave 0 were one pixel.
  double direction_sigma_rad() const;
  // True if the newest frame has nearly the same pose in both: bundle adjustment may turn rivals into the same
  // structure.
  bool same_as(const InitialStructure& other) const;

  // Returns the views and points of the map, to which the caller adds the frames.
  InitialMap finish() const;

 private:
  struct View {
    size_t frame = 0;  // index into the input's frames
    SE3 cam_from_reference;
    std::vector<int> keypoints;  // by point; kNone if it has none
    std::vector<bool> agrees;    // by point: its error is that of an inlier
  };
  std::vector<int> keypoints_in(size_t frame) const;
  View make_view(size_t frame, const SE3& cam_from_reference) const;
  BundleProblem::Observation observation(size_t view, size_t point) const;
  std::optional<SE3> resect_frame(size_t frame, const SE3& neighbour) const;
  // Returns a problem with all views and points, without observations.
  BundleProblem as_it_is() const;
  bool solve(const std::vector<size_t>& chosen, int iterations);
  void sort_out();

  const FollowedFrames* input_;
  std::vector<int> reference_keypoints_;  // by point
  std::vector<Eigen::Vector3d> points_;   // positions in the reference's frame
  std::vector<View> views_;               // the reference, the newest frame, then those between in order of time
};

}  // namespace rumi::front_tracker
