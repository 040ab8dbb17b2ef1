// SPDX-License-Identifier: BSD-3-Clause
// Matches landmarks to a frame's keypoints near their predicted pixels.
#pragma once

#include <vector>

#include "front_tracker/frame/frame.h"

namespace rumi::front_tracker {

struct ProjectionSearch {
  double radius_px = 15;         // search radius at octave 0; grows with the predicted octave's scale
  int max_distance = 64;         // Hamming distance of a match, at most
  double max_ratio = 0.9;        // best / second-best distance, at most, unless the best is at most half of
                                 // max_distance
  int octaves_below = 1;         // octaves by which a keypoint may be finer than predicted
  int octaves_above = 1;         // octaves by which a keypoint may be coarser than predicted
  double min_view_cosine = 0.5;  // least cosine of the angle between the landmark's mean viewing direction and this one
};

// A landmark's predicted pixel at a pose. predict() returns nullopt if it lies outside the image, if its octave would
// lie outside the pyramid, or if the viewing direction differs too much.
struct Prediction {
  Eigen::Vector2f pixel;  // undistorted
  int octave = 0;
};
std::optional<Prediction> predict(const Camera& camera, const SE3& cam_from_submap, const Landmark& landmark,
                                  const std::vector<double>& octave_scales, double min_view_cosine);

// Returns the best unmatched keypoint near the prediction, or kNone.
int find_keypoint(const Frame& frame, const Prediction& at, const Descriptor& descriptor,
                  const ProjectionSearch& search, const std::vector<double>& octave_scales);

// Matches those landmarks that are not matched in the frame yet, at its present pose. Returns the number of matches.
// `visible`, if given, receives the ids of all given landmarks that should be in view.
int search_by_projection(const Camera& camera, const std::vector<const Landmark*>& landmarks,
                         const ProjectionSearch& search, const std::vector<double>& octave_scales, Frame* frame,
                         std::vector<int>* visible = nullptr);

}  // namespace rumi::front_tracker
