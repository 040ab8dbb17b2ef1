// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/report/evaluation_plot.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "rumi/report/plot_axes.h"
#include "slam/numeric/median.h"

namespace rumi::tool {
namespace {

constexpr int kWidth = 1000, kTopHeight = 600, kErrorHeight = 300, kMargin = 60;

// False if frames are missing in between, so that no line should join the two.
bool neighbours(int64_t a_us, int64_t b_us, int64_t period_us) { return b_us - a_us <= 3 * period_us; }

int64_t usual_period_us(const std::vector<PoseError>& errors) {
  std::vector<int64_t> periods;
  for (size_t i = 1; i < errors.size(); ++i) periods.push_back(errors[i].utime_us - errors[i - 1].utime_us);
  return median(&periods);
}

// Returns the two directions in which the truth extends most, as rows.
Eigen::Matrix<double, 2, 3> widest_plane(const std::vector<TimedPose>& truth) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const TimedPose& pose : truth) mean += pose.map_from_cam.translation / static_cast<double>(truth.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const TimedPose& pose : truth) {
    const Eigen::Vector3d d = pose.map_from_cam.translation - mean;
    covariance += d * d.transpose();
  }
  const Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvectors();
  Eigen::Matrix<double, 2, 3> plane;
  plane << axes.col(2).transpose(), axes.col(1).transpose();
  return plane;
}

void draw_paths(cv::Mat& image, const RunMetrics& metrics, const std::vector<TimedPose>& truth, int64_t period_us) {
  const auto plane = widest_plane(truth);
  std::vector<Eigen::Vector2d> path;
  path.reserve(truth.size());
  for (const TimedPose& pose : truth) path.push_back(plane * pose.map_from_cam.translation);
  Eigen::Vector2d low = path[0], high = path[0];
  const auto include = [&](const Eigen::Vector2d& p) { low = low.cwiseMin(p), high = high.cwiseMax(p); };
  for (const auto& p : path) include(p);
  for (const PoseError& error : metrics.map.errors) include(plane * error.estimate_m);
  // Both axes have the same scale.
  const cv::Rect area(kMargin, kMargin, kWidth - 2 * kMargin, kTopHeight - 2 * kMargin);
  const Eigen::Vector2d middle = (low + high) / 2, extent = (high - low).cwiseMax(1e-6) * 1.1;
  const double per_pixel = std::max(extent.x() / area.width, extent.y() / area.height);
  const Eigen::Vector2d half(per_pixel * area.width / 2, per_pixel * area.height / 2);
  const PlotAxes axes(image, area, middle.x() - half.x(), middle.x() + half.x(), middle.y() - half.y(),
                      middle.y() + half.y(), "m");
  for (size_t i = 1; i < path.size(); ++i) {
    cv::line(image, axes.at(path[i - 1].x(), path[i - 1].y()), axes.at(path[i].x(), path[i].y()), kPlotGrey, 2,
             cv::LINE_AA);
  }
  const auto& errors = metrics.map.errors;
  for (size_t i = 1; i < errors.size(); ++i) {
    if (!neighbours(errors[i - 1].utime_us, errors[i].utime_us, period_us)) continue;
    const Eigen::Vector2d a = plane * errors[i - 1].estimate_m, b = plane * errors[i].estimate_m;
    cv::line(image, axes.at(a.x(), a.y()), axes.at(b.x(), b.y()), kPlotBlue, 1, cv::LINE_AA);
  }
  plot_text(image, "truth", {kWidth - 320, 40}, kPlotGrey);
  plot_text(image, "estimate, Sim(3) aligned", {kWidth - 260, 40}, kPlotBlue);
}

void draw_errors(cv::Mat& image, const RunMetrics& metrics, int64_t period_us) {
  const auto& errors = metrics.map.errors;
  double highest = 1e-6;
  for (const PoseError& error : errors) highest = std::max(highest, error.distance_m);
  const int64_t begin_us = errors.front().utime_us;
  const double duration_s = std::max(1e-3, static_cast<double>(errors.back().utime_us - begin_us) * 1e-6);
  const cv::Rect area(kMargin, kTopHeight + 10, kWidth - 2 * kMargin, kErrorHeight - kMargin);
  const PlotAxes axes(image, area, 0, duration_s, 0, highest * 1.1, "m");
  const auto point = [&](const PoseError& e) {
    return axes.at(static_cast<double>(e.utime_us - begin_us) * 1e-6, e.distance_m);
  };
  for (size_t i = 1; i < errors.size(); ++i) {
    if (!neighbours(errors[i - 1].utime_us, errors[i].utime_us, period_us)) continue;
    cv::line(image, point(errors[i - 1]), point(errors[i]), kPlotRed, 1, cv::LINE_AA);
  }
  plot_text(image, "distance from the truth over time (s)", {kMargin + 8, kTopHeight + 28}, kPlotRed);
}

}  // namespace

cv::Mat draw_evaluation(const RunMetrics& metrics, const std::vector<TimedPose>& truth) {
  cv::Mat image(kTopHeight + kErrorHeight, kWidth, CV_8UC3, kPlotWhite);
  if (metrics.map.errors.size() < 2 || !metrics.map.ate_rmse_m) {
    plot_text(image, "nothing to show: " + metrics.map.reason, {kMargin, kMargin});
  } else {
    const int64_t period_us = usual_period_us(metrics.map.errors);
    draw_paths(image, metrics, truth, period_us);
    draw_errors(image, metrics, period_us);
    plot_text(image,
              fmt::format("ATE RMSE {:.4f} m (Sim(3)), {} of {} frames tracked", *metrics.map.ate_rmse_m,
                          metrics.tracked_frames, metrics.frames),
              {kMargin, 40});
  }
  return image;
}

Result<> plot_evaluation(const RunMetrics& metrics, const std::vector<TimedPose>& truth, const std::string& png_file) {
  // Opening the file tells why it cannot be written. OpenCV does not.
  errno = 0;
  if (!std::ofstream(png_file, std::ios::app))
    return Error{fmt::format("cannot be written ({})", std::strerror(errno)), png_file};
  try {
    if (cv::imwrite(png_file, draw_evaluation(metrics, truth))) return {};
  } catch (const cv::Exception&) {
    // The error below says it in plain words.
  }
  return Error{"cannot be written", png_file};
}

}  // namespace rumi::tool
