// SPDX-License-Identifier: BSD-3-Clause
// A model of all images of a window at once, without a first pair to go wrong with: rotations averaged over all
// verified pairs, then positions of cameras and points together (Pan et al., "Global Structure-from-Motion Revisited",
// ECCV 2024). COLMAP's incremental mapper can settle on a confident wrong solution when the camera turns more than it
// moves; a model started from here gives it a rival to be compared with.
#pragma once

#include <optional>
#include <vector>

#include "ruminator/matching/window_image.h"
#include "ruminator/model/sparse_model.h"
#include "slam/geometry/camera.h"

namespace rumi::ruminator {

constexpr int kMinTrackImages = 3;  // so many images must see a point of the global model

struct RelativeRotation {
  int first = 0, second = 0;  // images
  Eigen::Quaterniond second_from_first;
  const ImagePair* pair = nullptr;
};

// Returns the rotation of every pair that has enough matches and an essential matrix that determines it.
std::vector<RelativeRotation> relative_rotations(const Camera& camera, const std::vector<WindowImage>& images,
                                                 const std::vector<ImagePair>& pairs);

// Computes rough poses and points of the largest connected part, for adjust_model() to refine. Nothing if fewer than
// three images hang together. Deterministic.
std::optional<SparseModel> build_global_model(const Camera& camera, const std::vector<WindowImage>& images,
                                              const std::vector<RelativeRotation>& rotations,
                                              int min_track_images = kMinTrackImages);

// Returns the median difference, in degrees, between the rotations of pairs and those of the model; 180 if no pair has
// poses for both images. The median is taken over matches, not pairs, because the rotation of a pair with few matches
// is uncertain.
double median_rotation_error_deg(const std::vector<RelativeRotation>& rotations, const SparseModel& model);

}  // namespace rumi::ruminator
