// SPDX-License-Identifier: BSD-3-Clause
// COLMAP's model made complete and exact: focal lengths as calibrated, images that the mapper left out tried once more,
// everything adjusted together.
#pragma once

#include <limits>
#include <optional>
#include <set>
#include <vector>

#include "ruminator/matching/tracks.h"
#include "ruminator/matching/window_image.h"
#include "ruminator/model/sparse_model.h"
#include "slam/geometry/camera.h"

namespace rumi::ruminator {

struct ModelRefinementOptions {
  double max_error_px = 3.0;      // of an observation
  double min_parallax_deg = 1.5;  // between the outer rays of a point
  int resection_min_inliers = 15;
};

struct ModelQuality {
  double rmse_px = 0;  // of all observations
  int observations = 0;
};

// With their observations, and the points that fewer than two images are left to see.
void remove_images(const std::set<int>& images, SparseModel* model);

// Does the point have that angle between two of its rays?
bool has_parallax(const SparseModel& model, const SparseModel::Point& point, double min_parallax_deg);

// Removes observations beyond the error limit, points without parallax and images that lose all their points.
void prune_model(const Camera& camera, const std::vector<WindowImage>& images, const ModelRefinementOptions& options,
                 SparseModel* model);

ModelQuality model_quality(const Camera& camera, const std::vector<WindowImage>& images, const SparseModel& model);

// Bundle adjustment with the calibrated camera, then prune_model, and both once more. The first registered view keeps
// its pose.
ModelQuality adjust_model(const Camera& camera, const std::vector<WindowImage>& images,
                          const ModelRefinementOptions& options, SparseModel* model);

// The point of a track whose images all have poses: of the pairs of rays the one that most of the others agree with
// (all pairs of a short track, of a long one those of its first, middle and last image). Nothing without parallax.
std::optional<SparseModel::Point> triangulate_track(const Camera& camera, const std::vector<WindowImage>& images,
                                                    const Track& track, const ModelRefinementOptions& options,
                                                    const SparseModel& model);

// The model's points anew: every track of two or more images with a pose, from the two of its rays that most others
// agree with.
void triangulate_tracks(const Camera& camera, const std::vector<WindowImage>& images, const std::vector<Track>& tracks,
                        const ModelRefinementOptions& options, SparseModel* model);

// Removes images whose place is not determined: those with fewer than resection_min_inliers points that the other
// images alone place (with half the parallax asked of a point). What such an image sees fits wherever it is put along
// its rays. Returns how many went.
int remove_loose_images(const ModelRefinementOptions& options, SparseModel* model);

// The first and the last images of a model (images are in order of time) hang on one side only, unless front_tracker
// knows where kHoldingImages of them in a row are: fewer join the model to nothing. An end of up to kMostLooseImages
// goes unless the others place kOpenEndFactor times resection_min_inliers points of it, and then the next: where the
// light goes out, a few wrong matches among as many right ones carry such an end away step by step, and images that see
// points of their own have any scale. Returns how many went; adjust_model should follow.
constexpr int kOpenEndFactor = 2;
constexpr int kHoldingImages = 3;
constexpr int kMostLooseImages = 3;
int trim_open_ends(const std::set<int>& known, const ModelRefinementOptions& options, SparseModel* model);

// Removes images that are farther from the middle of all (the median of the positions) than kMaxStray times the median
// distance of a point to a camera that sees it: a few images and points of their own, put where their scale is another
// by orders of magnitude, contradict nothing. Returns how many went; adjust_model should follow.
constexpr double kMaxStray = 100;
int remove_strays(SparseModel* model);

// Images without a pose get one by resection over their verified matches with images that have one; then their matches
// become observations and new points. Returns how many were added, `limit` at most; adjust_model should follow.
int resect_missing_images(const Camera& camera, const std::vector<WindowImage>& images,
                          const std::vector<ImagePair>& pairs, const ModelRefinementOptions& options,
                          SparseModel* model, int limit = std::numeric_limits<int>::max());

}  // namespace rumi::ruminator
