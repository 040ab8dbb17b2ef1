// SPDX-License-Identifier: BSD-3-Clause
#include "slam/geometry/two_view.h"

#include <fmt/core.h>

#include <algorithm>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>

#include "slam/geometry/triangulation.h"

namespace rumi {
namespace {

std::vector<cv::Point2d> normalized(const Camera& camera, const std::vector<Eigen::Vector2f>& pixels) {
  std::vector<cv::Point2d> points;
  points.reserve(pixels.size());
  for (const Eigen::Vector2f& p : pixels)
    points.emplace_back((p.x() - camera.cx) / camera.fx, (p.y() - camera.cy) / camera.fy);
  return points;
}

SE3 pose_from(const cv::Mat& rotation, const cv::Mat& translation) {
  Eigen::Matrix3d r;
  Eigen::Vector3d t;
  cv::cv2eigen(rotation, r);
  cv::cv2eigen(translation, t);
  return {r, t.normalized()};
}

void add_essential_poses(const cv::Mat& first, const cv::Mat& second, double threshold, std::vector<SE3>* poses) {
  const cv::Mat e = cv::findEssentialMat(first, second, cv::Mat::eye(3, 3, CV_64F), cv::RANSAC, 0.999, threshold);
  if (e.rows < 3 || e.cols != 3) return;
  cv::Mat r1, r2, t;
  cv::decomposeEssentialMat(e.rowRange(0, 3), r1, r2, t);
  for (const cv::Mat& r : {r1, r2})
    for (const double sign : {1.0, -1.0}) poses->push_back(pose_from(r, sign * t));
}

void add_homography_poses(const cv::Mat& first, const cv::Mat& second, double threshold, std::vector<SE3>* poses) {
  const cv::Mat h = cv::findHomography(first, second, cv::RANSAC, threshold);
  if (h.empty()) return;
  std::vector<cv::Mat> rotations, translations, normals;
  cv::decomposeHomographyMat(h, cv::Mat::eye(3, 3, CV_64F), rotations, translations, normals);
  for (size_t i = 0; i < rotations.size(); ++i)
    if (cv::norm(translations[i]) > 1e-6) poses->push_back(pose_from(rotations[i], translations[i]));
}

// Points that the pose explains, with parallax enough to be worth something.
TwoViewResult judge(const Camera& camera, const SE3& second_from_first, const std::vector<cv::Point2d>& first,
                    const std::vector<cv::Point2d>& second, const TwoViewOptions& options) {
  TwoViewResult result;
  result.second_from_first = second_from_first;
  result.points.resize(first.size());
  const double f = 0.5 * (camera.fx + camera.fy);
  const double max_error2 = std::pow(options.max_error_px / f, 2);
  const Eigen::Vector3d center = second_from_first.center();
  std::vector<double> parallaxes;
  for (size_t i = 0; i < first.size(); ++i) {
    const Eigen::Vector3d a(first[i].x, first[i].y, 1), b(second[i].x, second[i].y, 1);
    const auto point = triangulate(SE3(), a, second_from_first, b);
    if (!point) continue;
    const Eigen::Vector3d q = second_from_first * *point;
    const double error_a = (point->hnormalized() - a.head<2>()).squaredNorm();
    const double error_b = (q.hnormalized() - b.head<2>()).squaredNorm();
    if (error_a > max_error2 || error_b > max_error2) continue;
    parallaxes.push_back(parallax_rad(*point, Eigen::Vector3d::Zero(), center));
    result.points[i] = *point;
  }
  result.inliers = static_cast<int>(parallaxes.size());
  if (parallaxes.empty()) return result;
  std::nth_element(parallaxes.begin(), parallaxes.begin() + parallaxes.size() / 2, parallaxes.end());
  result.median_parallax_deg = parallaxes[parallaxes.size() / 2] * 180 / M_PI;
  return result;
}

bool same_pose(const SE3& a, const SE3& b) {
  const double direction = std::acos(std::clamp(a.translation.dot(b.translation), -1.0, 1.0));
  return (a * b.inverse()).angle_rad() < 0.03 && direction < 0.35;
}

}  // namespace

TwoViewResult reconstruct_two_views(const Camera& camera, const std::vector<Eigen::Vector2f>& first_px,
                                    const std::vector<Eigen::Vector2f>& second_px, const TwoViewOptions& options) {
  TwoViewResult best;
  if (static_cast<int>(first_px.size()) < options.min_points) {
    best.refusal = fmt::format("{} matches, {} needed", first_px.size(), options.min_points);
    return best;
  }
  const std::vector<cv::Point2d> first = normalized(camera, first_px), second = normalized(camera, second_px);
  const double threshold = options.max_error_px / (0.5 * (camera.fx + camera.fy));
  std::vector<SE3> poses;
  add_essential_poses(cv::Mat(first), cv::Mat(second), threshold, &poses);
  add_homography_poses(cv::Mat(first), cv::Mat(second), 1.5 * threshold, &poses);

  std::vector<TwoViewResult> candidates;
  for (const SE3& pose : poses) candidates.push_back(judge(camera, pose, first, second, options));
  if (candidates.empty()) {
    best.refusal = "neither an essential matrix nor a homography fits";
    return best;
  }
  best = *std::max_element(candidates.begin(), candidates.end(),
                           [](const auto& a, const auto& b) { return a.inliers < b.inliers; });
  int rival = 0;
  for (const TwoViewResult& c : candidates)
    if (!same_pose(c.second_from_first, best.second_from_first)) rival = std::max(rival, c.inliers);

  if (best.inliers < options.min_points)
    best.refusal = fmt::format("{} points, {} needed", best.inliers, options.min_points);
  else if (best.inliers < 0.6 * first.size())
    best.refusal = fmt::format("only {} of {} matches fit", best.inliers, first.size());
  else if (best.median_parallax_deg < options.min_median_parallax_deg)
    best.refusal =
        fmt::format("parallax {:.2f} deg, {:.2f} needed", best.median_parallax_deg, options.min_median_parallax_deg);
  else if (rival > options.max_rival_ratio * best.inliers)
    best.refusal = fmt::format("ambiguous: another pose explains {} of {} points", rival, best.inliers);
  return best;
}

}  // namespace rumi
