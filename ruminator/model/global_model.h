// SPDX-License-Identifier: BSD-3-Clause
// Builds a model from all images of a window at once, without a first pair that may be wrong: averages the rotations of
// all verified pairs, then solves for the positions of cameras and points together (Pan et al., "Global
// Structure-from-Motion Revisited", ECCV 2024). COLMAP's incremental mapper can settle on a wrong solution with small
// errors if the camera rotates more than it moves; a model built from this one is a second candidate to compare it
// with.
#pragma once

#include <optional>
#include <vector>

#include "ruminator/matching/window_image.h"
#include "ruminator/model/sparse_model.h"
#include "slam/geometry/camera.h"

namespace rumi::ruminator {

constexpr int kMinTrackImages = 3;  // a point of the global model is seen by at least this many images

struct RelativeRotation {
  int first = 0, second = 0;  // indices of the two images
  Eigen::Quaterniond second_from_first;
  const ImagePair* pair = nullptr;
};

// Returns the relative rotations of the pairs that have enough matches and an essential matrix that determines it.
std::vector<RelativeRotation> relative_rotations(const Camera& camera, const std::vector<WindowImage>& images,
                                                 const std::vector<ImagePair>& pairs);

// Computes rough poses and points of the largest connected part, which adjust_model() has to refine. Returns nullopt if
// fewer than three images are connected. Deterministic.
std::optional<SparseModel> build_global_model(const Camera& camera, const std::vector<WindowImage>& images,
                                              const std::vector<RelativeRotation>& rotations,
                                              int min_track_images = kMinTrackImages);

// Returns the median difference, in degrees, between the rotations of pairs and those of the model; 180 if no pair has
// poses for both images. It is the median over matches, not over pairs, because the rotation of a pair with few matches
// is uncertain.
double median_rotation_error_deg(const std::vector<RelativeRotation>& rotations, const SparseModel& model);

}  // namespace rumi::ruminator
