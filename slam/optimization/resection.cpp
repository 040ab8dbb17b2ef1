// SPDX-License-Identifier: BSD-3-Clause
#include "slam/optimization/resection.h"

#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>

namespace rumi {

std::optional<PoseResult> resect(const Camera& camera, const std::vector<PointObservation>& observations,
                                 const ResectionOptions& options) {
  if (static_cast<int>(observations.size()) < std::max(options.min_inliers, 6)) return std::nullopt;
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> pixels;
  for (const PointObservation& o : observations) {
    points.emplace_back(o.point.x(), o.point.y(), o.point.z());
    pixels.emplace_back(o.pixel.x(), o.pixel.y());
  }
  const cv::Matx33d k(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  cv::Mat rvec, tvec, inlier_indices;
  bool found = false;
  try {
    found = cv::solvePnPRansac(points, pixels, k, cv::noArray(), rvec, tvec, false, options.iterations,
                               static_cast<float>(options.max_error_px), 0.99, inlier_indices, cv::SOLVEPNP_P3P);
  } catch (const cv::Exception&) {
    return std::nullopt;  // OpenCV's solver throws at some degenerate samples
  }
  if (!found || inlier_indices.rows < std::max(options.min_inliers / 2, 4)) return std::nullopt;
  cv::Mat rotation;
  cv::Rodrigues(rvec, rotation);
  Eigen::Matrix3d r;
  Eigen::Vector3d t;
  cv::cv2eigen(rotation, r);
  cv::cv2eigen(tvec, t);
  if (!r.allFinite() || !t.allFinite()) return std::nullopt;
  PoseOptimizerOptions refine;
  refine.first_gate_chi2 = 4 * options.max_error_px * options.max_error_px;
  PoseResult result = optimize_pose(camera, SE3(r, t), observations, refine);
  if (!result.converged || result.inliers < options.min_inliers) return std::nullopt;
  return result;
}

}  // namespace rumi
