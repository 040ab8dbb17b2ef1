// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/calibration/calibrator.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>

#include "rumi/calibration/coverage.h"
#include "rumi/calibration/lens_solver.h"
#include "slam/numeric/median.h"

namespace rumi::tool {
namespace {

CornerPairs correspondences(const Board& board, const BoardView& view) {
  CornerPairs out;
  for (size_t i = 0; i < view.corners.size(); ++i) {
    const cv::Point2d mm = board.corner_mm(view.corners[i]);
    out.board_mm.emplace_back(mm.x, mm.y, 0);
    out.pixels.emplace_back(view.pixels[i]);
  }
  return out;
}

std::vector<CornerPairs> correspondences(const Board& board, const std::vector<BoardView>& views) {
  std::vector<CornerPairs> out;
  out.reserve(views.size());
  for (const BoardView& view : views) out.push_back(correspondences(board, view));
  return out;
}

// Returns at most `count` of the views: the first, then again and again the one that differs most from those chosen.
// Appends the others to *rest.
std::vector<BoardView> most_different(const std::vector<BoardView>& views, size_t count, const Board& board,
                                      cv::Size image, std::vector<BoardView>* rest) {
  std::vector<ViewShape> shapes;
  shapes.reserve(views.size());
  for (const BoardView& view : views) shapes.push_back(shape_of(view, board, image));
  std::vector<double> difference(views.size(), std::numeric_limits<double>::infinity());
  std::vector<BoardView> chosen;
  while (chosen.size() < std::min(count, views.size())) {
    const size_t next = std::max_element(difference.begin(), difference.end()) - difference.begin();
    chosen.push_back(views[next]);
    for (size_t i = 0; i < views.size(); ++i)
      difference[i] = std::min(difference[i], shapes[next].difference(shapes[i]));
    difference[next] = -1;
  }
  for (size_t i = 0; i < views.size(); ++i)
    if (difference[i] >= 0) rest->push_back(views[i]);
  return chosen;
}

// If all boards are parallel to each other, any focal length fits, with another distance of the boards (Zhang, section
// 4), and the standard deviations of the solution do not show this. An Error if too few boards are tilted.
Result<> check_tilts(const std::vector<Eigen::Vector3d>& normals, const CalibratorOptions& options) {
  Eigen::Vector3d mean(0, 0, 0);
  for (const Eigen::Vector3d& normal : normals) mean += normal;
  const double least = std::cos(options.min_tilt_deg * M_PI / 180) * mean.norm();
  const auto tilted =
      std::count_if(normals.begin(), normals.end(), [&](const Eigen::Vector3d& n) { return n.dot(mean) <= least; });
  if (tilted >= options.min_tilted_views) return {};
  return Error{fmt::format(
      "in {} of {} views the board is tilted by {} degrees or more against the others: it must be in at least {}, or "
      "the focal length cannot be told from the distance; tilt it by 30 to 45 degrees, to the left, right, up and down",
      tilted, normals.size(), options.min_tilt_deg, options.min_tilted_views)};
}

LensSolution solve(const std::vector<BoardView>& views, const Board& board, cv::Size image, Camera::Model model) {
  const std::vector<CornerPairs> data = correspondences(board, views);
  return model == Camera::Model::kPinhole ? solve_pinhole(data, image) : solve_fisheye(data, image);
}

// Removes views that do not fit, and adds them to *outliers. True if it removed any.
bool remove_outliers(const LensSolution& solution, const CalibratorOptions& options, std::vector<BoardView>* views,
                     std::vector<std::string>* outliers) {
  std::vector<double> errors = solution.view_rms_px;
  const double middle = median(&errors);
  for (double& error : errors) error = std::abs(error - middle);
  const double limit =
      std::max(middle + options.outlier_deviations * kSigmaFromMad * median(&errors), options.outlier_factor * middle);
  std::vector<BoardView> kept;
  for (size_t i = 0; i < views->size(); ++i) {
    if (solution.view_rms_px[i] <= limit)
      kept.push_back((*views)[i]);
    else
      outliers->push_back(fmt::format("{}: {:.2f} px", (*views)[i].where, solution.view_rms_px[i]));
  }
  if (kept.size() == views->size() || kept.size() < options.min_views) {
    outliers->clear();
    return false;
  }
  *views = std::move(kept);
  return true;
}

void check_with(const std::vector<BoardView>& spare, const Board& board, size_t max_views, Calibration* calibration) {
  const size_t stride = std::max<size_t>(1, (spare.size() + max_views - 1) / max_views);
  double sum = 0;
  size_t corners = 0;
  for (size_t i = 0; i < spare.size(); i += stride) {
    const double error = view_error_px(calibration->camera, correspondences(board, spare[i]));
    if (error < 0) continue;
    sum += error * error * static_cast<double>(spare[i].corners.size());
    corners += spare[i].corners.size();
    ++calibration->check_views;
  }
  if (corners > 0) calibration->check_rms_px = std::sqrt(sum / static_cast<double>(corners));
}

// Far from all corners that were seen, the distortion polynomial may turn back, so that different rays have the same
// pixel. False if that happens in a corner of the image.
bool holds_in_corners(const Camera& camera) {
  constexpr double kMaxError = 0.5;  // px; largest error of a pixel that is unprojected and projected again
  for (const double x : {0.0, camera.width - 1.0}) {
    for (const double y : {0.0, camera.height - 1.0}) {
      const Eigen::Vector2d pixel(x, y);
      const std::optional<Eigen::Vector2d> again = camera.project(camera.unproject(pixel));
      if (!again || !((*again - pixel).norm() < kMaxError)) return false;
    }
  }
  return true;
}

std::vector<std::string> find_doubts(const Calibration& calibration, const CalibratorOptions& options) {
  std::vector<std::string> doubts;
  const Camera& camera = calibration.camera;
  if (const std::string problem = camera.check(); !problem.empty()) doubts.push_back(problem);
  if (calibration.rms_px > options.max_rms_px)
    doubts.push_back(
        fmt::format("the reprojection error is {:.2f} px, more than {} px (--max-rms): is this the board that was "
                    "held, is it flat, "
                    "is it the right model (--model), is the focus fixed?",
                    calibration.rms_px, options.max_rms_px));
  for (const CalibratedParameter& p : calibration.parameters) {
    if (p.name[0] != 'f' || p.stddev <= options.max_focal_stddev * p.value) continue;
    doubts.push_back(fmt::format("{} is uncertain by {:.1f} %: more views with the board tilted are needed", p.name,
                                 100 * p.stddev / p.value));
  }
  // A fisheye lens may see 180 degrees and more. It is not tested, because unproject() is not defined for such pixels.
  if (camera.model == Camera::Model::kPinhole && !holds_in_corners(camera))
    doubts.push_back(
        "the distortion turns back within the image: show the board in the image's corners, or take --model fisheye");
  return doubts;
}

void set_parameters(const LensSolution& solution, Calibration* calibration) {
  const Camera& c = calibration->camera = solution.camera;
  std::vector<CalibratedParameter> all = {{"fx", c.fx, 0}, {"fy", c.fy, 0}, {"cx", c.cx, 0},
                                          {"cy", c.cy, 0}, {"k1", c.k1, 0}, {"k2", c.k2, 0}};
  if (c.model == Camera::Model::kPinhole)
    all.insert(all.end(), {{"p1", c.p1, 0}, {"p2", c.p2, 0}, {"k3", c.k3, 0}});
  else
    all.insert(all.end(), {{"k3", c.k3, 0}, {"k4", c.k4, 0}});
  for (size_t i = 0; i < all.size(); ++i) {
    all[i].stddev = solution.stddev[i];
    if (all[i].stddev > 0) calibration->parameters.push_back(all[i]);
  }
}

}  // namespace

Result<Calibration> calibrate(const Board& board, const std::vector<BoardView>& taken,
                              const std::vector<BoardView>& spare, cv::Size image, Camera::Model model,
                              const CalibratorOptions& options) try {
  Calibration calibration;
  std::vector<BoardView> rest = spare;
  std::vector<BoardView> views = most_different(taken, options.max_views, board, image, &rest);
  if (views.size() < options.min_views)
    return Error{fmt::format("{} different views of the board are too few: at least {} are needed, 20 to 50 are good",
                             views.size(), options.min_views)};
  LensSolution solution = solve(views, board, image, model);
  if (remove_outliers(solution, options, &views, &calibration.outliers)) solution = solve(views, board, image, model);
  set_parameters(solution, &calibration);
  calibration.rms_px = solution.rms_px;
  if (const Result<> tilted = check_tilts(solution.normals, options); !tilted) return tilted.error();
  calibration.views = views.size();
  for (const BoardView& view : views) calibration.corners += view.corners.size();
  check_with(rest, board, options.max_check_views, &calibration);
  calibration.doubts = find_doubts(calibration, options);
  return calibration;
} catch (const cv::Exception& e) {
  return Error{fmt::format(
      "no {} camera fits these views ({}): is it the right model (--model), is it the board that was held, and was it "
      "tilted to all sides?",
      model == Camera::Model::kPinhole ? "pinhole" : "fisheye", e.err)};
}

}  // namespace rumi::tool
