// SPDX-License-Identifier: BSD-3-Clause
// Completes and refines a model with the calibrated camera: removes what is not certain, resects images that the mapper
// left out, triangulates points, and adjusts cameras and points together.
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
  double min_parallax_deg = 1.5;  // least angle between the outermost rays of a point
  int resection_min_inliers = 15;
};

struct ModelQuality {
  double rmse_px = 0;  // root mean square error of all observations
  int observations = 0;
};

// Removes the images and their observations, and then the points that fewer than two images still see.
void remove_images(const std::set<int>& images, SparseModel* model);

// True if two rays of the point have an angle of at least min_parallax_deg between them.
bool has_parallax(const SparseModel& model, const SparseModel::Point& point, double min_parallax_deg);

// Removes observations with errors above the limit, points without parallax, and images that see fewer than
// resection_min_inliers of the remaining points.
void prune_model(const Camera& camera, const std::vector<WindowImage>& images, const ModelRefinementOptions& options,
                 SparseModel* model);

ModelQuality model_quality(const Camera& camera, const std::vector<WindowImage>& images, const SparseModel& model);

// Runs bundle adjustment with the calibrated camera, then prune_model(); both twice. The first registered image keeps
// its pose. Returns the quality of the result.
ModelQuality adjust_model(const Camera& camera, const std::vector<WindowImage>& images,
                          const ModelRefinementOptions& options, SparseModel* model);

// Triangulates a track whose images all have poses. Each pair of rays gives a candidate (in a long track only the pairs
// of the first, the middle and the last image). Returns the candidate with which most rays agree; nullopt if these are
// fewer than two, or have no parallax.
std::optional<SparseModel::Point> triangulate_track(const Camera& camera, const std::vector<WindowImage>& images,
                                                    const Track& track, const ModelRefinementOptions& options,
                                                    const SparseModel& model);

// Replaces the model's points by triangulating every track that has two or more images with a pose.
void triangulate_tracks(const Camera& camera, const std::vector<WindowImage>& images, const std::vector<Track>& tracks,
                        const ModelRefinementOptions& options, SparseModel* model);

// Removes images whose position is not determined: those in which fewer than resection_min_inliers points can be
// triangulated by the other images alone (with half of min_parallax_deg). The other points of such an image would fit
// any position along its rays, so they prove nothing. Returns the number of removed images.
int remove_loose_images(const ModelRefinementOptions& options, SparseModel* model);

// Removes loose images from the ends of a model: the first and the last images in time have neighbours on one side
// only. In the dark, a few wrong matches among as many right ones move such an end away step by step, and images that
// see only points of their own can have any scale. An end holds if front_tracker has the poses (`known`) of its
// outermost kHoldingImages images. Otherwise, groups of its outermost 1, 2, ... kMostLooseImages images are tested. A
// group is removed if the other images triangulate fewer than kOpenEndFactor * resection_min_inliers of the points that
// it sees. This is repeated until both ends hold. Returns the number of removed images; adjust_model() must be called
// after it.
constexpr int kOpenEndFactor = 2;
constexpr int kHoldingImages = 3;
constexpr int kMostLooseImages = 3;
int trim_open_ends(const std::set<int>& known, const ModelRefinementOptions& options, SparseModel* model);

// Removes images that are farther from the median of all positions than kMaxStray times the median distance between a
// point and a camera that sees it. A few images with points of their own can have a scale that is wrong by orders of
// magnitude, and nothing in the model contradicts them. Returns the number of removed images; adjust_model() must be
// called after it.
constexpr double kMaxStray = 100;
int remove_strays(SparseModel* model);

// Gives poses to images without one, by resection with the points to which their verified matches lead. Then their
// matches become observations and new points. Adds at most `limit` images and returns how many; adjust_model() must be
// called after it.
int resect_missing_images(const Camera& camera, const std::vector<WindowImage>& images,
                          const std::vector<ImagePair>& pairs, const ModelRefinementOptions& options,
                          SparseModel* model, int limit = std::numeric_limits<int>::max());

}  // namespace rumi::ruminator
