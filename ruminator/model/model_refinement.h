// SPDX-License-Identifier: BSD-3-Clause
// Completes and refines COLMAP's model: sets the calibrated focal lengths, resects images that the mapper left out, and
// adjusts everything together.
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
  double max_error_px = 3.0;      // largest reprojection error of an observation
  double min_parallax_deg = 1.5;  // between the outer rays of a point
  int resection_min_inliers = 15;
};

struct ModelQuality {
  double rmse_px = 0;  // of all observations
  int observations = 0;
};

// Removes the images, their observations, and the points that fewer than two of the other images see.
void remove_images(const std::set<int>& images, SparseModel* model);

// True if two rays of the point meet at min_parallax_deg or more.
bool has_parallax(const SparseModel& model, const SparseModel::Point& point, double min_parallax_deg);

// Removes observations beyond the error limit, points without parallax and images that lose all their points.
void prune_model(const Camera& camera, const std::vector<WindowImage>& images, const ModelRefinementOptions& options,
                 SparseModel* model);

ModelQuality model_quality(const Camera& camera, const std::vector<WindowImage>& images, const SparseModel& model);

// Runs bundle adjustment with the calibrated camera and prune_model, twice. The first registered view keeps its pose.
ModelQuality adjust_model(const Camera& camera, const std::vector<WindowImage>& images,
                          const ModelRefinementOptions& options, SparseModel* model);

// Triangulates a track whose images all have poses. Each pair of rays gives a point (of a long track only the pairs of
// its first, middle and last image); the point that most other rays agree with is returned. Nothing without parallax.
std::optional<SparseModel::Point> triangulate_track(const Camera& camera, const std::vector<WindowImage>& images,
                                                    const Track& track, const ModelRefinementOptions& options,
                                                    const SparseModel& model);

// Replaces the model's points: triangulates every track of two or more images with a pose.
void triangulate_tracks(const Camera& camera, const std::vector<WindowImage>& images, const std::vector<Track>& tracks,
                        const ModelRefinementOptions& options, SparseModel* model);

// Removes images whose position is not determined: those that see fewer than resection_min_inliers points that the
// other images alone can triangulate (with half of min_parallax_deg). The other points of such an image would follow it
// to any position along its rays, so they say nothing. Returns the number of removed images.
int remove_loose_images(const ModelRefinementOptions& options, SparseModel* model);

// Removes loose ends. The first and the last images of a model (in order of time) are connected on one side only,
// unless front_tracker has poses of kHoldingImages of them in a row. An end of up to kMostLooseImages images is removed
// if the others triangulate fewer than kOpenEndFactor * resection_min_inliers points that it sees; then the next end is
// tested. Where images get dark, a few wrong matches among as many right ones move such an end away step by step, and
// images that see only points of their own can have any scale. Returns the number of removed images; call adjust_model
// after it.
constexpr int kOpenEndFactor = 2;
constexpr int kHoldingImages = 3;
constexpr int kMostLooseImages = 3;
int trim_open_ends(const std::set<int>& known, const ModelRefinementOptions& options, SparseModel* model);

// Removes images that are farther from the median of all positions than kMaxStray times the median distance from a
// point to a camera that sees it. A few images with points of their own can have a scale that is wrong by orders of
// magnitude, and nothing in the model contradicts them. Returns the number of removed images; call adjust_model after
// it.
constexpr double kMaxStray = 100;
int remove_strays(SparseModel* model);

// Gives poses to images without one, by resection: their verified matches with images that have a pose lead to points.
// Then their matches become observations and new points. Adds at most `limit` images and returns their number; call
// adjust_model after it.
int resect_missing_images(const Camera& camera, const std::vector<WindowImage>& images,
                          const std::vector<ImagePair>& pairs, const ModelRefinementOptions& options,
                          SparseModel* model, int limit = std::numeric_limits<int>::max());

}  // namespace rumi::ruminator
