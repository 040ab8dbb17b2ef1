// SPDX-License-Identifier: BSD-3-Clause
#include "slam/geometry/two_view.h"

#include <fmt/core.h>

#include <algorithm>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>

#include "slam/geometry/relative_pose.h"
#include "slam/geometry/triangulation.h"
#include "slam/numeric/median.h"

namespace rumi {
namespace {

constexpr int kMostSamples = 200;  // RANSAC samples: enough if half of the pairs are right; fewer are refused

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
  const cv::Mat e =
      cv::findEssentialMat(first, second, cv::Mat::eye(3, 3, CV_64F), cv::RANSAC, 0.999, threshold, kMostSamples);
  if (e.rows < 3 || e.cols != 3) return;
  cv::Mat r1, r2, t;
  cv::decomposeEssentialMat(e.rowRange(0, 3), r1, r2, t);
  for (const cv::Mat& r : {r1, r2})
    for (const double sign : {1.0, -1.0}) poses->push_back(pose_from(r, sign * t));
}

void add_homography_poses(const cv::Mat& first, const cv::Mat& second, double threshold, std::vector<SE3>* poses) {
  const cv::Mat h = cv::findHomography(first, second, cv::RANSAC, threshold, cv::noArray(), kMostSamples);
  if (h.empty()) return;
  std::vector<cv::Mat> rotations, translations, normals;
  cv::decomposeHomographyMat(h, cv::Mat::eye(3, 3, CV_64F), rotations, translations, normals);
  for (size_t i = 0; i < rotations.size(); ++i)
    if (cv::norm(translations[i]) > 1e-6) poses->push_back(pose_from(rotations[i], translations[i]));
}

// Triangulates the points whose reprojection errors in both views are small enough.
TwoViewHypothesis judge(const Camera& camera, const SE3& second_from_first, const std::vector<cv::Point2d>& first,
                        const std::vector<cv::Point2d>& second, const TwoViewOptions& options) {
  TwoViewHypothesis result;
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
  result.median_parallax_deg = median(&parallaxes) * 180 / M_PI;
  return result;
}

// Fits the pose to all matches that agree with it, because a pose from a minimal sample is off by about a degree.
// Returns `rough` if fewer matches agree afterwards.
TwoViewHypothesis refine(const Camera& camera, const TwoViewHypothesis& rough, const std::vector<cv::Point2d>& first,
                         const std::vector<cv::Point2d>& second, const TwoViewOptions& options) {
  std::vector<Eigen::Vector2d> a, b;
  for (size_t i = 0; i < first.size(); ++i) {
    if (!rough.points[i]) continue;
    a.emplace_back(first[i].x, first[i].y);
    b.emplace_back(second[i].x, second[i].y);
  }
  SE3 pose = rough.second_from_first;
  refine_relative_pose(a, b, 2.0 / (camera.fx + camera.fy), &pose);
  TwoViewHypothesis refined = judge(camera, pose, first, second, options);
  return refined.inliers >= rough.inliers ? refined : rough;
}

bool same_pose(const SE3& a, const SE3& b) {
  const double direction = std::acos(std::clamp(a.translation.dot(b.translation), -1.0, 1.0));
  return (a * b.inverse()).angle_rad() < 0.03 && direction < 0.35;
}

// Sorts the hypotheses, best first, and keeps only the best of those with almost the same pose.
void keep_different(std::vector<TwoViewHypothesis>* hypotheses) {
  std::stable_sort(hypotheses->begin(), hypotheses->end(),
                   [](const auto& a, const auto& b) { return a.inliers > b.inliers; });
  std::vector<TwoViewHypothesis> kept;
  for (TwoViewHypothesis& h : *hypotheses)
    if (std::none_of(kept.begin(), kept.end(),
                     [&h](const TwoViewHypothesis& k) { return same_pose(h.second_from_first, k.second_from_first); }))
      kept.push_back(std::move(h));
  *hypotheses = std::move(kept);
}

// Returns at most kMost points, evenly picked (the same ones from both views): minimal samples need no more.
std::vector<cv::Point2d> sample(const std::vector<cv::Point2d>& points) {
  constexpr size_t kMost = 400;
  if (points.size() <= kMost) return points;
  std::vector<cv::Point2d> some;
  for (size_t i = 0; i < kMost; ++i) some.push_back(points[i * points.size() / kMost]);
  return some;
}

}  // namespace

TwoViewResult reconstruct_two_views(const Camera& camera, const std::vector<Eigen::Vector2f>& first_px,
                                    const std::vector<Eigen::Vector2f>& second_px, const TwoViewOptions& options) {
  TwoViewResult result;
  if (static_cast<int>(first_px.size()) < options.min_points) {
    result.refusal = fmt::format("{} matches, {} needed", first_px.size(), options.min_points);
    return result;
  }
  const std::vector<cv::Point2d> first = normalized(camera, first_px), second = normalized(camera, second_px);
  const double threshold = options.max_error_px / (0.5 * (camera.fx + camera.fy));
  std::vector<SE3> poses;
  const std::vector<cv::Point2d> some_first = sample(first), some_second = sample(second);
  add_essential_poses(cv::Mat(some_first), cv::Mat(some_second), threshold, &poses);
  add_homography_poses(cv::Mat(some_first), cv::Mat(some_second), 1.5 * threshold, &poses);

  std::vector<TwoViewHypothesis> all;
  int most = 0;
  for (const SE3& pose : poses) {
    all.push_back(judge(camera, pose, some_first, some_second, options));
    most = std::max(most, all.back().inliers);
  }
  std::erase_if(all, [&](const TwoViewHypothesis& h) { return h.inliers < options.max_rival_ratio * most; });
  keep_different(&all);
  for (TwoViewHypothesis& h : all) {
    h = refine(camera, h, some_first, some_second, options);
    h = judge(camera, h.second_from_first, first, second, options);
  }
  keep_different(&all);

  if (most == 0) {
    result.refusal = "neither an essential matrix nor a homography fits";
  } else if (const TwoViewHypothesis& best = all.front(); best.inliers < options.min_points) {
    result.refusal = fmt::format("{} points, {} needed", best.inliers, options.min_points);
  } else if (best.inliers < 0.6 * static_cast<double>(first.size())) {
    result.refusal = fmt::format("only {} of {} matches fit", best.inliers, first.size());
  } else if (best.median_parallax_deg < options.min_median_parallax_deg) {
    result.refusal =
        fmt::format("parallax {:.2f} deg, {:.2f} needed", best.median_parallax_deg, options.min_median_parallax_deg);
  }
  if (!result.ok()) return result;
  const double enough = options.max_rival_ratio * all.front().inliers;
  for (TwoViewHypothesis& h : all)
    if (h.inliers >= enough) result.hypotheses.push_back(std::move(h));
  return result;
}

}  // namespace rumi
