// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/model/global_model.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>
#include <random>

#include "ruminator/matching/opencv_usac.h"
#include "ruminator/matching/tracks.h"
#include "ruminator/matching/window_matches.h"

namespace rumi::ruminator {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr size_t kMinPairMatches = 20;      // least matches of an image pair from which a relative rotation is computed
constexpr double kMaxRotationErrorDeg = 5;  // a pair that differs more from the averaged rotations is left out
constexpr int kTracksPerImage = 200;        // tracks are selected until each image has this many, if it has them
constexpr int kIterations = 100;            // most iterations of the joint solution for cameras and points

std::optional<Quaterniond> relative_rotation(const Camera& camera, const std::vector<WindowImage>& images,
                                             const ImagePair& pair) {
  std::vector<cv::Point2d> a, b;
  for (const auto& [i, j] : pair.matches) {
    const Vector3d ra = camera.ray(images[pair.first].keypoints[i]), rb = camera.ray(images[pair.second].keypoints[j]);
    a.emplace_back(ra.x(), ra.y());
    b.emplace_back(rb.x(), rb.y());
  }
  cv::Mat rotation, translation;
  try {
    const cv::Mat k = cv::Mat::eye(3, 3, CV_64F);
    // The matches are verified, so few samples suffice. The best model is refined over all matches.
    const double pixel = 1 / (0.5 * (camera.fx + camera.fy));
    const cv::UsacParams usac = usac_params({.max_distance = 1.5 * pixel, .confidence = 0.999, .iterations = 200});
    const cv::Mat essential = cv::findEssentialMat(a, b, k, k, cv::noArray(), cv::noArray(), cv::noArray(), usac);
    if (essential.rows != 3 || cv::recoverPose(essential, a, b, k, rotation, translation) < 10) return std::nullopt;
  } catch (const cv::Exception&) {
    return std::nullopt;
  }
  Eigen::Matrix3d r;
  cv::cv2eigen(rotation, r);
  if (!r.allFinite()) return std::nullopt;
  return Quaterniond(r);
}

struct RotationError {
  Quaterniond second_from_first;
  template <class T>
  bool operator()(const T* a, const T* b, T* residual) const {
    const Eigen::Map<const Eigen::Quaternion<T>> qa(a), qb(b);
    Eigen::Quaternion<T> d = second_from_first.cast<T>() * qa * qb.conjugate();
    if (d.w() < T(0)) d.coeffs() = -d.coeffs();
    Eigen::Map<Eigen::Matrix<T, 3, 1>>{residual} = T(2) * d.vec();
    return true;
  }
};

std::vector<RelativeRotation> in_largest_part(size_t images, std::vector<RelativeRotation> rotations) {
  std::vector<ImagePair> pairs;
  pairs.reserve(rotations.size());
  for (const RelativeRotation& r : rotations) pairs.push_back({r.first, r.second, {}});
  const std::vector<int> part = connected_images(static_cast<int>(images), pairs, 0);
  std::erase_if(rotations, [&part](const RelativeRotation& r) { return part[r.first] != 0; });
  return rotations;
}

// Chains the rotations cam_from_world along the tree of the strongest pairs, then adjusts all of them together by
// robust least squares.
std::vector<std::optional<Quaterniond>> average_rotations(size_t images, std::vector<RelativeRotation> pairs) {
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const auto& a, const auto& b) { return a.pair->matches.size() > b.pair->matches.size(); });
  std::vector<std::optional<Quaterniond>> rotations(images);
  if (pairs.empty()) return rotations;
  rotations[pairs[0].first] = Quaterniond::Identity();
  for (bool grown = true; grown;) {
    grown = false;
    for (const RelativeRotation& p : pairs) {
      if (rotations[p.first].has_value() == rotations[p.second].has_value()) continue;
      if (rotations[p.first])
        rotations[p.second] = p.second_from_first * *rotations[p.first];
      else
        rotations[p.first] = p.second_from_first.conjugate() * *rotations[p.second];
      grown = true;
      break;  // begins again with the strongest pair that extends the tree
    }
  }
  ceres::Problem problem;
  for (auto& q : rotations)
    if (q) problem.AddParameterBlock(q->coeffs().data(), 4, new ceres::EigenQuaternionManifold);
  for (const RelativeRotation& p : pairs) {
    if (!rotations[p.first] || !rotations[p.second]) continue;
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<RotationError, 3, 4, 4>(new RotationError{p.second_from_first}),
        new ceres::CauchyLoss(0.02), rotations[p.first]->coeffs().data(), rotations[p.second]->coeffs().data());
  }
  problem.SetParameterBlockConstant(rotations[pairs[0].first]->coeffs().data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return rotations;
}

// Selects the longest tracks until each image has enough of them. More tracks would cost time and add little.
std::vector<Track> select_tracks(std::vector<Track> tracks, size_t images, int min_track_images) {
  std::stable_sort(tracks.begin(), tracks.end(), [](const Track& a, const Track& b) { return a.size() > b.size(); });
  std::vector<int> count(images, 0);
  std::vector<Track> selected;
  for (Track& track : tracks) {
    if (static_cast<int>(track.size()) < min_track_images) break;
    const bool is_wanted =
        std::any_of(track.begin(), track.end(), [&](const auto& o) { return count[o.first] < kTracksPerImage; });
    if (!is_wanted) continue;
    for (const auto& [image, keypoint] : track) ++count[image];
    selected.push_back(std::move(track));
  }
  return selected;
}

// Residual of the direction from the camera's centre to the point. It is bilinear, and therefore lacks the local minima
// that a reprojection error has far from the solution.
struct DirectionError {
  Vector3d direction;
  template <class T>
  bool operator()(const T* center, const T* point, const T* scale, T* residual) const {
    for (int i = 0; i < 3; ++i) residual[i] = T(direction[i]) - scale[0] * (point[i] - center[i]);
    return true;
  }
};

void position(const Camera& camera, const std::vector<WindowImage>& images,
              const std::vector<std::optional<Quaterniond>>& rotations, const std::vector<Track>& tracks,
              SparseModel* model) {
  std::mt19937 random(0);
  const auto uniform = [&random] { return static_cast<double>(random()) / 4294967296.0 * 2 - 1; };
  const auto anywhere = [&uniform] {
    const double x = uniform(), y = uniform();
    return Vector3d(x, y, uniform());
  };
  std::vector<Vector3d> centers(images.size());
  for (Vector3d& c : centers) c = anywhere();
  model->points.clear();
  size_t observations = 0;
  for (const Track& track : tracks) observations += track.size();
  std::vector<double> scales(observations, 1.0);

  ceres::Problem problem;
  auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (const Track& track : tracks) model->points.push_back({anywhere(), track});
  size_t s = 0;
  std::vector<char> seen(images.size(), 0);
  for (SparseModel::Point& point : model->points) {
    for (const auto& [image, keypoint] : point.track) {
      const Vector3d direction =
          rotations[image]->conjugate() * camera.ray(images[image].keypoints[keypoint]).normalized();
      double* scale = &scales[s++];
      problem.AddResidualBlock(
          new ceres::AutoDiffCostFunction<DirectionError, 3, 3, 3, 1>(new DirectionError{direction}),
          new ceres::HuberLoss(0.1), centers[image].data(), point.position.data(), scale);
      problem.SetParameterLowerBound(scale, 0, 1e-5);
      ordering->AddElementToGroup(scale, 0);
      seen[image] = 1;
    }
    ordering->AddElementToGroup(point.position.data(), 1);
  }
  for (size_t i = 0; i < centers.size(); ++i)
    if (seen[i]) ordering->AddElementToGroup(centers[i].data(), 2);
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  solver.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;  // CHOLMOD would start its own threads
  solver.linear_solver_ordering = ordering;
  solver.max_num_iterations = kIterations;
  solver.function_tolerance = 1e-5;
  solver.num_threads = 1;
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  for (size_t i = 0; i < images.size(); ++i)
    if (seen[i]) model->cam_from_world[static_cast<int>(i)] = SE3(*rotations[i], -(*rotations[i] * centers[i]));
}

}  // namespace

std::vector<RelativeRotation> relative_rotations(const Camera& camera, const std::vector<WindowImage>& images,
                                                 const std::vector<ImagePair>& pairs) {
  std::vector<RelativeRotation> rotations;
  for (const ImagePair& pair : pairs) {
    if (pair.matches.size() < kMinPairMatches) continue;
    if (const auto rotation = relative_rotation(camera, images, pair))
      rotations.push_back({pair.first, pair.second, *rotation, &pair});
  }
  return rotations;
}

std::optional<SparseModel> build_global_model(const Camera& camera, const std::vector<WindowImage>& images,
                                              const std::vector<RelativeRotation>& rotations, int min_track_images) {
  const auto averaged = average_rotations(images.size(), in_largest_part(images.size(), rotations));
  const double max_error = kMaxRotationErrorDeg * M_PI / 180;
  std::vector<ImagePair> consistent;
  for (const RelativeRotation& p : rotations)
    if (averaged[p.first] && averaged[p.second] &&
        p.second_from_first.angularDistance(*averaged[p.second] * averaged[p.first]->conjugate()) <= max_error)
      consistent.push_back(*p.pair);
  const std::vector<Track> tracks = select_tracks(join_tracks(images, consistent), images.size(), min_track_images);
  SparseModel model;
  model.fx = camera.fx;
  model.fy = camera.fy;
  position(camera, images, averaged, tracks, &model);
  if (model.cam_from_world.size() < 3) return std::nullopt;
  return model;
}

double median_rotation_error_deg(const std::vector<RelativeRotation>& rotations, const SparseModel& model) {
  std::vector<std::pair<double, size_t>> angles;  // angle in radians, number of matches
  size_t matches = 0;
  for (const RelativeRotation& r : rotations) {
    const auto first = model.cam_from_world.find(r.first), second = model.cam_from_world.find(r.second);
    if (first == model.cam_from_world.end() || second == model.cam_from_world.end()) continue;
    const Eigen::Quaterniond second_from_first = second->second.rotation * first->second.rotation.conjugate();
    angles.emplace_back(r.second_from_first.angularDistance(second_from_first), r.pair->matches.size());
    matches += r.pair->matches.size();
  }
  std::sort(angles.begin(), angles.end());
  size_t below = 0;
  for (const auto& [angle, count] : angles)
    if (below += count; 2 * below >= matches) return angle * 180 / M_PI;
  return 180;
}

}  // namespace rumi::ruminator
