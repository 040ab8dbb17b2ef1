// SPDX-License-Identifier: BSD-3-Clause
// The structure from two frames and the frames between them, with which Initializer begins a submap.
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

// The first structure of a submap, in the frame of its first view, scaled to a median depth of 1.
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
  std::vector<Frame> frames;  // all buffered frames in order of time; those without a view have no pose yet
  std::vector<View> views;
  std::vector<Point> points;
};

// The buffered frames, and a reference whose keypoints were followed through the frames after it.
struct FollowedFrames {
  const Camera& camera;
  const InitializerOptions& options;
  const std::vector<double>& octave_scales;
  const std::deque<Frame>& frames;  // also those before the reference
  size_t reference = 0;             // index into frames
  const ReferenceTracks& tracks;
};

class InitialStructure {
 public:
  // `pair` has the reference and the newest frame as its views; its points are at `keypoints` of the reference. `input`
  // must outlive the structure.
  InitialStructure(const FollowedFrames& input, const TwoViewHypothesis& pair, const std::vector<int>& keypoints);

  // Adds the frames between the two, which check the structure at little cost. An Error says that most of them do not
  // agree with it: it is wrong.
  Result<> add_views_between();
  // Adjusts the structure by bundle adjustment. An Error says that it does not hold.
  Result<> adjust();
  // The RMS error of all matches in the views, each cut off at the limit of an outlier. It compares rivals.
  double error_px() const;
  // The standard deviation of the direction of the motion between the two, if a keypoint's noise were one pixel at
  // octave 0.
  double direction_sigma_rad() const;
  // True if the two have the same poses: bundle adjustment may make rivals one.
  bool same_as(const InitialStructure& other) const;

  // Returns the views and points of the map. The caller adds the frames.
  InitialMap finish() const;

 private:
  struct View {
    size_t frame = 0;  // index into the input's frames
    SE3 cam_from_reference;
    std::vector<int> keypoints;  // for each point its keypoint, or kNone
    std::vector<bool> agrees;    // for each point
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
  std::vector<int> reference_keypoints_;  // for each point
  std::vector<Eigen::Vector3d> points_;   // in the reference's frame
  std::vector<View> views_;               // the reference, the newest, then those between in order of time
};

}  // namespace rumi::front_tracker
