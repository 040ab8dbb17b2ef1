// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/evaluation_plot.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "slam/geometry/median.h"

namespace rumi {
namespace {

const cv::Scalar kWhite(255, 255, 255), kBlack(30, 30, 30), kGrid(225, 225, 225), kTruth(150, 150, 150),
    kEstimate(190, 90, 20), kError(40, 40, 200);
constexpr int kWidth = 1000, kTopHeight = 600, kErrorHeight = 300, kMargin = 60;

void text(cv::Mat& image, const std::string& words, cv::Point at, const cv::Scalar& colour = kBlack) {
  cv::putText(image, words, at, cv::FONT_HERSHEY_SIMPLEX, 0.45, colour, 1, cv::LINE_AA);
}

// 1, 2 or 5 times a power of ten, so that `range` has about `steps` of them.
double round_step(double range, int steps) {
  const double raw = range / steps;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  for (double factor : {1.0, 2.0, 5.0}) {
    if (raw <= factor * power) return factor * power;
  }
  return 10 * power;
}

// A rectangle of the picture with linear axes; the grid is drawn on construction.
class Axes {
 public:
  Axes(cv::Mat& image, cv::Rect area, double x_min, double x_max, double y_min, double y_max, const char* unit)
      : image_(image), area_(area), x_min_(x_min), y_min_(y_min) {
    x_scale_ = area.width / (x_max - x_min);
    y_scale_ = area.height / (y_max - y_min);
    const double x_step = round_step(x_max - x_min, 8), y_step = round_step(y_max - y_min, 5);
    for (double x = std::ceil(x_min / x_step) * x_step; x <= x_max; x += x_step) {
      const cv::Point p = at(x, y_min);
      cv::line(image_, p, at(x, y_max), kGrid);
      text(image_, fmt::format("{:.4g}", std::abs(x) < 1e-9 ? 0.0 : x), {p.x - 10, p.y + 18});
    }
    for (double y = std::ceil(y_min / y_step) * y_step; y <= y_max; y += y_step) {
      const cv::Point p = at(x_min, y);
      cv::line(image_, p, at(x_max, y), kGrid);
      text(image_, fmt::format("{:.4g} {}", std::abs(y) < 1e-9 ? 0.0 : y, unit), {p.x - 54, p.y + 4});
    }
    cv::rectangle(image_, area_, kTruth);
  }
  cv::Point at(double x, double y) const {
    return {area_.x + cvRound((x - x_min_) * x_scale_), area_.y + area_.height - cvRound((y - y_min_) * y_scale_)};
  }

 private:
  cv::Mat& image_;
  cv::Rect area_;
  double x_min_, y_min_, x_scale_ = 1, y_scale_ = 1;
};

// Time gaps well beyond the usual period are not bridged with a line.
bool neighbours(int64_t a_us, int64_t b_us, int64_t period_us) { return b_us - a_us <= 3 * period_us; }

int64_t usual_period_us(const std::vector<PoseError>& errors) {
  std::vector<int64_t> periods;
  for (size_t i = 1; i < errors.size(); ++i) periods.push_back(errors[i].utime_us - errors[i - 1].utime_us);
  return median(&periods);
}

// Rows: the two directions in which the truth extends most.
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
  for (const TimedPose& pose : truth) path.push_back(plane * pose.map_from_cam.translation);
  Eigen::Vector2d low = path[0], high = path[0];
  const auto include = [&](const Eigen::Vector2d& p) { low = low.cwiseMin(p), high = high.cwiseMax(p); };
  for (const auto& p : path) include(p);
  for (const PoseError& error : metrics.map.errors) include(plane * error.estimate_m);
  // The same scale on both axes.
  const cv::Rect area(kMargin, kMargin, kWidth - 2 * kMargin, kTopHeight - 2 * kMargin);
  const Eigen::Vector2d middle = (low + high) / 2, extent = (high - low).cwiseMax(1e-6) * 1.1;
  const double per_pixel = std::max(extent.x() / area.width, extent.y() / area.height);
  const Eigen::Vector2d half(per_pixel * area.width / 2, per_pixel * area.height / 2);
  const Axes axes(image, area, middle.x() - half.x(), middle.x() + half.x(), middle.y() - half.y(),
                  middle.y() + half.y(), "m");
  for (size_t i = 1; i < path.size(); ++i) {
    cv::line(image, axes.at(path[i - 1].x(), path[i - 1].y()), axes.at(path[i].x(), path[i].y()), kTruth, 2,
             cv::LINE_AA);
  }
  const auto& errors = metrics.map.errors;
  for (size_t i = 1; i < errors.size(); ++i) {
    if (!neighbours(errors[i - 1].utime_us, errors[i].utime_us, period_us)) continue;
    const Eigen::Vector2d a = plane * errors[i - 1].estimate_m, b = plane * errors[i].estimate_m;
    cv::line(image, axes.at(a.x(), a.y()), axes.at(b.x(), b.y()), kEstimate, 1, cv::LINE_AA);
  }
  text(image, "truth", {kWidth - 320, 40}, kTruth);
  text(image, "estimate, Sim(3) aligned", {kWidth - 260, 40}, kEstimate);
}

void draw_errors(cv::Mat& image, const RunMetrics& metrics, int64_t period_us) {
  const auto& errors = metrics.map.errors;
  double highest = 1e-6;
  for (const PoseError& error : errors) highest = std::max(highest, error.distance_m);
  const int64_t begin_us = errors.front().utime_us;
  const double duration_s = std::max(1e-3, static_cast<double>(errors.back().utime_us - begin_us) * 1e-6);
  const cv::Rect area(kMargin, kTopHeight + 10, kWidth - 2 * kMargin, kErrorHeight - kMargin);
  const Axes axes(image, area, 0, duration_s, 0, highest * 1.1, "m");
  const auto point = [&](const PoseError& e) {
    return axes.at(static_cast<double>(e.utime_us - begin_us) * 1e-6, e.distance_m);
  };
  for (size_t i = 1; i < errors.size(); ++i) {
    if (!neighbours(errors[i - 1].utime_us, errors[i].utime_us, period_us)) continue;
    cv::line(image, point(errors[i - 1]), point(errors[i]), kError, 1, cv::LINE_AA);
  }
  text(image, "distance from the truth over time (s)", {kMargin + 8, kTopHeight + 28}, kError);
}

}  // namespace

cv::Mat draw_evaluation(const RunMetrics& metrics, const std::vector<TimedPose>& truth) {
  cv::Mat image(kTopHeight + kErrorHeight, kWidth, CV_8UC3, kWhite);
  if (metrics.map.errors.size() < 2 || !metrics.map.ate_rmse_m) {
    text(image, "nothing to show: " + metrics.map.reason, {kMargin, kMargin});
  } else {
    const int64_t period_us = usual_period_us(metrics.map.errors);
    draw_paths(image, metrics, truth, period_us);
    draw_errors(image, metrics, period_us);
    text(image,
         fmt::format("ATE RMSE {:.4f} m (Sim(3)), {} of {} frames tracked", *metrics.map.ate_rmse_m,
                     metrics.tracked_frames, metrics.frames),
         {kMargin, 40});
  }
  return image;
}

std::string plot_evaluation(const RunMetrics& metrics, const std::vector<TimedPose>& truth,
                            const std::string& png_file) {
  try {
    if (cv::imwrite(png_file, draw_evaluation(metrics, truth))) return "";
  } catch (const cv::Exception&) {
    // Said below, in words of our own.
  }
  return fmt::format("{}: cannot be written", png_file);
}

}  // namespace rumi
