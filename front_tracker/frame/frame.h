// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "slam/features/image_pyramid.h"
#include "slam/features/keypoint_grid.h"
#include "slam/map/submap.h"
#include "slam/optimization/pose_optimizer.h"

namespace rumi::front_tracker {

// Of an image. Few: it is blurred, dark or of a blank wall; patches may still be found. None: they were not looked for,
// its keypoints are landmarks found by patches.
enum class Corners { kEnough, kFew, kNone };

// How well a frame's pose, and the submap's scale where it is, are known.
struct PoseCertainty {
  // Of the camera's place and direction, given the landmarks: covariance of the twist (translation, rotation) in
  // exp(twist) * cam_from_submap. A landmark counts as far as its own place is known.
  Matrix6d twist_covariance = Matrix6d::Zero();
  // How far off that leaves what the image shows at the landmarks' median depth: RMS over the image, px.
  double image_px = 0;
  // Of the logarithm of the scale that the landmarks in view carry, against the submap's beginning: variance.
  double log_scale_variance = 0;
};

// One image on its way through the tracker.
struct Frame {
  int64_t utime_us = 0;
  std::shared_ptr<const Features> features;
  std::shared_ptr<const ImagePyramid> images;  // null: its keypoints stay where they were found
  KeypointGrid grid;                           // over the undistorted pixels
  std::vector<int> landmark_ids;               // per keypoint, kNone where nothing is matched
  SE3 cam_from_submap;                         // meaningful once tracked
  PoseCertainty certainty;                     // once tracked
  bool is_believable = true;                   // else the pose is nothing to build on
  Corners corners = Corners::kEnough;
  int reference_keyframe = kNone;
  SE3 cam_from_keyframe;

  int matches() const;
  void clear_matches();
};

Frame make_frame(int64_t utime_us, Features features, const Camera& camera);

// The frame's matches as observations for optimize_pose, and which keypoint each is.
struct FrameObservations {
  std::vector<PointObservation> observations;
  std::vector<int> keypoints;
};
FrameObservations observations_of(const Frame& frame, const Submap& submap, const std::vector<double>& octave_scales);

enum class Weights { kEqual, kByArea };  // see weigh_by_area.h

// optimize_pose over the frame's matches (and `views`): sets the pose, unmatches the outliers and returns the number of
// inliers (0 and an unchanged pose if it failed).
int refine_pose(const Camera& camera, const Submap& submap, const std::vector<double>& octave_scales, Frame* frame,
                Weights weights = Weights::kEqual, const std::vector<EpipolarView>& views = {});

}  // namespace rumi::front_tracker
