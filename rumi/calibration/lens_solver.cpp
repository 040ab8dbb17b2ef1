// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/calibration/lens_solver.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>

namespace rumi::tool {
namespace {

constexpr double kSignificant = 3;  // |k3| / its standard deviation, at least, if k3 is kept

const cv::TermCriteria kUntilConverged(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-9);

Camera make_camera(Camera::Model model, cv::Size image, const cv::Matx33d& k, const cv::Mat& distortion) {
  Camera camera;
  camera.model = model;
  camera.width = image.width, camera.height = image.height;
  camera.fx = k(0, 0), camera.fy = k(1, 1), camera.cx = k(0, 2), camera.cy = k(1, 2);
  const double* d = distortion.ptr<double>();
  camera.k1 = d[0], camera.k2 = d[1];
  if (model == Camera::Model::kPinhole)
    camera.p1 = d[2], camera.p2 = d[3], camera.k3 = d[4];
  else
    camera.k3 = d[2], camera.k4 = d[3];
  return camera;
}

Eigen::Vector3d normal_of(const cv::Mat& rotation) {
  cv::Matx33d turn;
  cv::Rodrigues(rotation, turn);
  return {turn(0, 2), turn(1, 2), turn(2, 2)};
}

LensSolution solve_pinhole(const std::vector<CornerPairs>& views, cv::Size image, bool with_k3) {
  // OpenCV's function requires floats.
  std::vector<std::vector<cv::Point3f>> board;
  std::vector<std::vector<cv::Point2f>> pixels;
  for (const CornerPairs& view : views) {
    board.emplace_back(view.board_mm.begin(), view.board_mm.end());
    pixels.emplace_back(view.pixels.begin(), view.pixels.end());
  }
  cv::Mat k, distortion, stddev, pose_stddev, view_rms;
  std::vector<cv::Mat> rotations, translations;
  LensSolution solution;
  solution.rms_px =
      cv::calibrateCamera(board, pixels, image, k, distortion, rotations, translations, stddev, pose_stddev, view_rms,
                          cv::CALIB_USE_QR | (with_k3 ? 0 : cv::CALIB_FIX_K3), kUntilConverged);
  solution.camera = make_camera(Camera::Model::kPinhole, image, k, distortion);
  constexpr int kParameters = 9;
  solution.stddev.assign(stddev.ptr<double>(), stddev.ptr<double>() + kParameters);
  for (const cv::Mat& rotation : rotations) solution.normals.push_back(normal_of(rotation));
  solution.view_rms_px.assign(view_rms.ptr<double>(), view_rms.ptr<double>() + views.size());
  return solution;
}

// Computes the pose of a board from the rays of its corners. False if there is none.
bool find_pose(const Camera& camera, const CornerPairs& view, cv::Vec3d* rotation, cv::Vec3d* translation) {
  std::vector<cv::Point2d> rays;
  for (const cv::Point2d& pixel : view.pixels) {
    const Eigen::Vector3d ray = camera.unproject({pixel.x, pixel.y});
    rays.emplace_back(ray.x(), ray.y());
  }
  try {
    return cv::solvePnP(view.board_mm, rays, cv::Matx33d::eye(), cv::noArray(), *rotation, *translation);
  } catch (const cv::Exception&) {
    return false;
  }
}

// Returns a camera from which cv::fisheye::calibrate() converges, as it does not from a poor start: a fisheye without
// distortion, with the focal length that fits a few of the views best.
Camera first_fisheye(const std::vector<CornerPairs>& views, cv::Size image) {
  // Focal length / width of the image; kStep: factor between two trials.
  constexpr double kNarrowest = 1.5, kWidest = 0.2, kStep = 0.9;
  constexpr size_t kViews = 8;
  Camera best, camera;
  camera.model = Camera::Model::kKannalaBrandt;
  camera.width = image.width, camera.height = image.height;
  camera.cx = (image.width - 1) / 2.0, camera.cy = (image.height - 1) / 2.0;
  const size_t stride = std::max<size_t>(1, views.size() / kViews);
  double least = std::numeric_limits<double>::infinity();
  for (double part = kNarrowest; part > kWidest; part *= kStep) {
    camera.fx = camera.fy = part * image.width;
    double sum = 0;
    for (size_t i = 0; i < views.size(); i += stride) {
      const double error = view_error_px(camera, views[i]);
      sum += error < 0 ? image.width : error;
    }
    if (sum < least) least = sum, best = camera;
  }
  return best;
}

struct FisheyeView {
  // Derivatives of the pixels by the 8 parameters of the lens, and by the 6 of the pose.
  Eigen::MatrixXd by_lens, by_pose;
  Eigen::VectorXd residuals;
};

FisheyeView linearize(const CornerPairs& view, const cv::Matx33d& k, const cv::Mat& distortion, const cv::Mat& rotation,
                      const cv::Mat& translation) {
  std::vector<cv::Point2d> projected;
  cv::Mat jacobian;  // columns: f (2), c (2), k (4), rotation (3), translation (3), skew
  cv::fisheye::projectPoints(view.board_mm, projected, rotation, translation, k, distortion, 0, jacobian);
  FisheyeView out;
  const int rows = jacobian.rows;
  const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> all(
      jacobian.ptr<double>(), rows, jacobian.cols);
  out.by_lens = all.leftCols(8);
  out.by_pose = all.middleCols(8, 6);
  out.residuals.resize(rows);
  for (int i = 0; i < rows / 2; ++i) {
    out.residuals[2 * i] = view.pixels[i].x - projected[i].x;
    out.residuals[2 * i + 1] = view.pixels[i].y - projected[i].y;
  }
  return out;
}

// Computes errors and standard deviations, which cv::fisheye does not return. The poses are eliminated from the normal
// equations.
void assess_fisheye(const std::vector<FisheyeView>& views, LensSolution* solution) {
  Eigen::Matrix<double, 8, 8> information = Eigen::Matrix<double, 8, 8>::Zero();
  double sum = 0;
  Eigen::Index values = 0;
  for (const FisheyeView& view : views) {
    const Eigen::Matrix<double, 8, 6> mixed = view.by_lens.transpose() * view.by_pose;
    const Eigen::Matrix<double, 6, 6> pose = view.by_pose.transpose() * view.by_pose;
    information += view.by_lens.transpose() * view.by_lens - mixed * pose.ldlt().solve(mixed.transpose());
    solution->view_rms_px.push_back(std::sqrt(view.residuals.squaredNorm() * 2 / view.residuals.size()));
    sum += view.residuals.squaredNorm();
    values += view.residuals.size();
  }
  solution->rms_px = std::sqrt(2 * sum / values);
  const auto freedom = static_cast<double>(values) - 8 - 6 * static_cast<double>(views.size());
  const Eigen::Matrix<double, 8, 8> covariance = information.inverse() * (sum / std::max(1.0, freedom));
  for (int i = 0; i < 8; ++i) {
    const double variance = covariance(i, i);
    // If the information matrix is singular, it yields no standard deviations.
    solution->stddev.push_back(variance >= 0 ? std::sqrt(variance) : std::numeric_limits<double>::infinity());
  }
}

}  // namespace

LensSolution solve_pinhole(const std::vector<CornerPairs>& views, cv::Size image) {
  LensSolution solution = solve_pinhole(views, image, true);
  if (std::abs(solution.camera.k3) < kSignificant * solution.stddev[8]) solution = solve_pinhole(views, image, false);
  return solution;
}

LensSolution solve_fisheye(const std::vector<CornerPairs>& views, cv::Size image) {
  std::vector<std::vector<cv::Point3d>> board;
  std::vector<std::vector<cv::Point2d>> pixels;
  for (const CornerPairs& view : views) {
    board.push_back(view.board_mm);
    pixels.push_back(view.pixels);
  }
  const Camera first = first_fisheye(views, image);
  cv::Matx33d k(first.fx, 0, first.cx, 0, first.fy, first.cy, 0, 0, 1);
  cv::Mat distortion = cv::Mat::zeros(4, 1, CV_64F);
  std::vector<cv::Mat> rotations, translations;
  cv::fisheye::calibrate(
      board, pixels, image, k, distortion, rotations, translations,
      cv::fisheye::CALIB_USE_INTRINSIC_GUESS | cv::fisheye::CALIB_RECOMPUTE_EXTRINSIC | cv::fisheye::CALIB_FIX_SKEW,
      kUntilConverged);
  LensSolution solution;
  solution.camera = make_camera(Camera::Model::kKannalaBrandt, image, k, distortion);
  std::vector<FisheyeView> linearized;
  for (const cv::Mat& rotation : rotations) solution.normals.push_back(normal_of(rotation));
  for (size_t i = 0; i < views.size(); ++i)
    linearized.push_back(linearize(views[i], k, distortion, rotations[i], translations[i]));
  assess_fisheye(linearized, &solution);
  return solution;
}

double view_error_px(const Camera& camera, const CornerPairs& view) {
  cv::Vec3d rotation, translation;
  if (!find_pose(camera, view, &rotation, &translation)) return -1;
  cv::Matx33d turn;
  cv::Rodrigues(rotation, turn);
  double sum = 0;
  for (size_t i = 0; i < view.pixels.size(); ++i) {
    const cv::Vec3d p = turn * cv::Vec3d(view.board_mm[i]) + translation;
    const std::optional<Eigen::Vector2d> pixel = camera.project({p[0], p[1], p[2]});
    if (!pixel) return -1;
    sum += (*pixel - Eigen::Vector2d(view.pixels[i].x, view.pixels[i].y)).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(view.pixels.size()));
}

}  // namespace rumi::tool
