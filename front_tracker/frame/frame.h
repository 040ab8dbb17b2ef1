// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "slam/features/image_pyramid.h"
#include "slam/features/keypoint_grid.h"
#include "slam/map/submap.h"
#include "slam/optimization/pose_optimizer.h"

namespace rumi::front_tracker {

// The corners of an image. kFew: the image is blurred, dark or shows a blank wall, but patches may still be found.
// kNone: nobody looked for corners; the keypoints are landmarks that were found by patches.
enum class Corners { kEnough, kFew, kNone };

// How well a frame's pose and the submap's scale at the frame are known.
struct PoseCertainty {
  // The covariance of the twist (translation, rotation) in exp(twist) * cam_from_submap, given the landmarks. Landmarks
  // with uncertain positions count less.
  Matrix6d twist_covariance = Matrix6d::Zero();
  // The error that twist_covariance causes in the image at the landmarks' median depth: RMS over the image, in pixels.
  double image_px = 0;
  // The variance of the log scale by the landmarks in view, relative to the submap's beginning.
  double log_scale_variance = 0;
};

// An image on its way through the tracker.
struct Frame {
  int64_t utime_us = 0;
  std::shared_ptr<const Features> features;
  std::shared_ptr<const ImagePyramid> images;  // null if the keypoints are not to be aligned
  KeypointGrid grid;                           // finds keypoints by their undistorted pixels
  std::vector<int> landmark_ids;               // by keypoint; kNone if it has no match
  SE3 cam_from_submap;                         // valid once the frame is tracked
  PoseCertainty certainty;                     // valid once the frame is tracked
  bool is_believable = true;                   // false: it must not become a keyframe
  Corners corners = Corners::kEnough;
  int reference_keyframe = kNone;
  SE3 cam_from_keyframe;

  int matches() const;
  void clear_matches();
};

Frame make_frame(int64_t utime_us, Features features, const Camera& camera);

// The frame's matches as observations for optimize_pose, and the keypoint of each.
struct FrameObservations {
  std::vector<PointObservation> observations;
  std::vector<int> keypoints;
};
FrameObservations observations_of(const Frame& frame, const Submap& submap, const std::vector<double>& octave_scales);

enum class Weights { kEqual, kByArea };  // see weigh_by_area.h

// Refines the pose with optimize_pose() on the frame's matches and `views`, and unmatches the outliers. Returns the
// number of inliers. If it fails, returns 0 and leaves the pose unchanged.
int refine_pose(const Camera& camera, const Submap& submap, const std::vector<double>& octave_scales, Frame* frame,
                Weights weights = Weights::kEqual, const std::vector<EpipolarView>& views = {});

}  // namespace rumi::front_tracker
