// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/frame/certainty.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "slam/map/landmark_view.h"
#include "slam/optimization/whitened_projection.h"

namespace rumi::front_tracker {
namespace {

using Matrix23d = Eigen::Matrix<double, 2, 3>;
using Matrix26d = Eigen::Matrix<double, 2, 6>;

// Returns the derivative of a projection by the point in the camera's frame, in units of the keypoint's noise.
Matrix23d derivative_by_point(const Camera& camera, double sigma_px, const Eigen::Vector3d& p) {
  return WhitenedProjection(camera, Eigen::Vector2d::Zero(), sigma_px, Eigen::Matrix2d::Identity()).derivative(p);
}

// Returns the derivative by a twist: exp(twist) moves p by its translation + its rotation x p.
Matrix26d derivative_by_twist(const Matrix23d& by_point, const Eigen::Vector3d& p) {
  Matrix26d a;
  a << by_point, -by_point * skew(p);
  return a;
}

double image_uncertainty_px(const Camera& camera, const Matrix6d& twist_covariance, double depth) {
  constexpr double kPlaces[] = {0.1, 0.5, 0.9};  // places in the image, as shares of its width and height
  double variance = 0;
  for (const double u : kPlaces)
    for (const double v : kPlaces) {
      const Eigen::Vector3d p = depth * camera.ray(Eigen::Vector2d(u * camera.width, v * camera.height));
      const Matrix26d a = derivative_by_twist(derivative_by_point(camera, 1, p), p);
      variance += (a * twist_covariance * a.transpose()).trace() / 9;
    }
  return std::sqrt(variance);
}

// Returns the information that a keypoint gives about the twist, lowered by the uncertainty of the landmark's position.
Matrix6d sight_of(const Camera& camera, const SE3& cam_from_submap, const Landmark& landmark, double sigma_px) {
  const Eigen::Vector3d p = cam_from_submap * landmark.position;
  if (!(p.z() > 1e-6)) return Matrix6d::Zero();
  const Matrix23d by_point = derivative_by_point(camera, sigma_px, p);
  const Matrix23d turned = by_point * cam_from_submap.rotation.toRotationMatrix();
  const Eigen::Matrix2d covariance =
      Eigen::Matrix2d::Identity() + turned * landmark.information.inverse() * turned.transpose();
  const Matrix26d by_twist = derivative_by_twist(by_point, p);
  return by_twist.transpose() * covariance.inverse() * by_twist;
}

// Returns the variance of the rotation about one axis.
double rotation_variance(const Matrix6d& twist_covariance) {
  return twist_covariance.bottomRightCorner<3, 3>().trace() / 3;
}

Matrix6d invert(const Matrix6d& information) {
  return (information + 1e-12 * Matrix6d::Identity()).ldlt().solve(Matrix6d::Identity());
}

}  // namespace

Matrix6d second_twist_covariance(const Camera& camera, const FreeStructure& structure) {
  // The information about all views but the first, from which the points are eliminated (Schur complement).
  const auto size = static_cast<Eigen::Index>(6 * (structure.cam_from_structure.size() - 1));
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(size, size);
  struct Part {
    Eigen::Index at;
    Eigen::Matrix<double, 6, 3> mixed;
  };
  std::vector<Part> parts;
  for (const FreeStructure::Point& point : structure.points) {
    Eigen::Matrix3d known = Eigen::Matrix3d::Zero();
    parts.clear();
    for (const FreeStructure::Sight& sight : point.sights) {
      const SE3& cam_from_structure = structure.cam_from_structure[sight.view];
      const Eigen::Vector3d p = cam_from_structure * point.position;
      if (!(p.z() > 1e-6)) continue;
      const Matrix23d by_cam_point = derivative_by_point(camera, sight.sigma_px, p);
      const Matrix23d by_point = by_cam_point * cam_from_structure.rotation.toRotationMatrix();
      known += by_point.transpose() * by_point;
      if (sight.view == 0) continue;
      const Matrix26d by_twist = derivative_by_twist(by_cam_point, p);
      const auto at = static_cast<Eigen::Index>(6 * (sight.view - 1));
      information.block<6, 6>(at, at) += by_twist.transpose() * by_twist;
      parts.push_back({at, by_twist.transpose() * by_point});
    }
    known.diagonal().array() += 1e-12 * known.trace();
    const Eigen::Matrix3d covariance = known.inverse();
    for (const Part& a : parts)
      for (const Part& b : parts) information.block<6, 6>(a.at, b.at) -= a.mixed * covariance * b.mixed.transpose();
  }
  const SE3 second_from_first = structure.cam_from_structure[1] * structure.cam_from_structure[0].inverse();
  const Eigen::Vector3d along = second_from_first.translation.normalized();
  information.topLeftCorner<3, 3>() += information.topLeftCorner<3, 3>().trace() * along * along.transpose();
  information.diagonal().array() += 1e-9;
  return Matrix6d(information.ldlt().solve(Eigen::MatrixXd::Identity(size, 6)).topRows<6>());
}

Eigen::Matrix3d position_covariance(const SE3& cam_from_submap, const Matrix6d& twist_covariance) {
  const Eigen::Matrix3d r = cam_from_submap.rotation.toRotationMatrix();
  // The twist moves the centre -R^T t by -R^T times its translation.
  return r.transpose() * twist_covariance.topLeftCorner<3, 3>() * r;
}

double log_length_variance(const Eigen::Vector3d& baseline, const Eigen::Matrix3d& position_covariance) {
  const double length2 = baseline.squaredNorm();
  if (!(length2 > 0)) return std::numeric_limits<double>::infinity();
  return baseline.dot(position_covariance * baseline) / (length2 * length2);
}

PoseCertainty certainty_of(const Submap& submap, const std::vector<double>& octave_scales, const Frame& frame,
                           const std::vector<EpipolarView>& views) {
  Matrix6d information = Matrix6d::Zero();
  double weights = 0, scale_variance = 0;
  for (size_t i = 0; i < frame.landmark_ids.size(); ++i) {
    const Landmark* lm = frame.landmark_ids[i] == kNone ? nullptr : submap.landmark(frame.landmark_ids[i]);
    if (!lm) continue;
    const double sigma_px = octave_scales[frame.features->keypoints[i].octave];
    const Matrix6d added = sight_of(submap.camera, frame.cam_from_submap, *lm, sigma_px);
    information += added;
    // Landmarks count for the scale as they count for the position: both are determined together.
    const double weight = added.topLeftCorner<3, 3>().trace();
    weights += weight;
    scale_variance += weight * lm->log_scale_variance;
  }
  for (const EpipolarView& view : views)
    information += epipolar_information(submap.camera, frame.cam_from_submap, view);
  PoseCertainty certainty;
  certainty.twist_covariance = invert(information);
  certainty.image_px = image_uncertainty_px(submap.camera, certainty.twist_covariance,
                                            median_depth(submap, frame.cam_from_submap, frame.landmark_ids));
  certainty.log_scale_variance = weights > 0 ? scale_variance / weights : 0;
  return certainty;
}

double log_baseline_variance(const FrontSubmap& submap, int keyframe_a, int keyframe_b) {
  const Eigen::Vector3d baseline = submap.map.keyframe(keyframe_a)->cam_from_submap.center() -
                                   submap.map.keyframe(keyframe_b)->cam_from_submap.center();
  double variance = 0;
  for (const int id : {keyframe_a, keyframe_b})
    if (const auto known = submap.certainty.find(id); known != submap.certainty.end())
      variance += log_length_variance(baseline, known->second.position_covariance);
  return variance;
}

double log_scale_variance_between(const FrontSubmap& submap, int newer_keyframe, int older_keyframe) {
  const auto known = submap.certainty.find(newer_keyframe);
  const double carried = known == submap.certainty.end() ? 0 : known->second.log_scale_variance;
  return carried + log_baseline_variance(submap, newer_keyframe, older_keyframe);
}

PoseSigmas sigmas_of(const FrontSubmap& submap, const Frame& frame) {
  const Matrix6d& c = frame.certainty.twist_covariance;
  // The twist moves the centre by its translation, only rotated: the trace stays the same.
  double position = c.topLeftCorner<3, 3>().trace() / 3, rotation = rotation_variance(c);
  constexpr double kNothing = 1e10;  // a larger variance means no information; see invert()
  if (!(position > 0 && position < kNothing && rotation > 0 && rotation < kNothing)) return {};
  // A keyframe is its own reference. Its own covariance then stands for that of its neighbours, which are known about
  // as well.
  const auto known = submap.certainty.find(frame.reference_keyframe);
  if (known != submap.certainty.end()) {
    position += known->second.position_covariance.trace() / 3;
    rotation += known->second.rotation_variance;
  }
  return pose_sigmas(std::sqrt(position), std::sqrt(rotation), std::sqrt(frame.certainty.log_scale_variance));
}

void note_certainty(int keyframe_id, const PoseCertainty& certainty, FrontSubmap* submap) {
  const Keyframe& kf = *submap->map.keyframe(keyframe_id);
  submap->certainty[keyframe_id] = {position_covariance(kf.cam_from_submap, certainty.twist_covariance),
                                    certainty.log_scale_variance, rotation_variance(certainty.twist_covariance)};
  for (const int id : kf.landmark_ids) {
    Landmark* lm = id == kNone ? nullptr : submap->map.landmark(id);
    if (!lm || lm->observations.front().keyframe_id == keyframe_id) continue;
    lm->log_scale_variance = std::min(
        lm->log_scale_variance, log_scale_variance_between(*submap, keyframe_id, lm->observations.front().keyframe_id));
  }
}

}  // namespace rumi::front_tracker
