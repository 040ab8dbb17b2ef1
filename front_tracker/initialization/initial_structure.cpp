// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/initialization/initial_structure.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "front_tracker/frame/certainty.h"
#include "slam/geometry/triangulation.h"
#include "slam/numeric/median.h"

namespace rumi::front_tracker {
namespace {

constexpr size_t kMostBetween = 10;        // frames between the two frames that check the structure, at most
constexpr size_t kMostPosePoints = 200;    // points that a frame's pose is found with, about
constexpr size_t kMostBundlePoints = 400;  // points in bundle adjustment; the others are triangulated afterwards
constexpr double kOutlierChi2 = 5.991;     // squared error of an outlier, at least, in sigma^2 (95 % in 2-D)

}  // namespace

InitialStructure::InitialStructure(const FollowedFrames& input, const TwoViewHypothesis& pair,
                                   const std::vector<int>& keypoints)
    : input_(&input) {
  for (size_t i = 0; i < keypoints.size(); ++i) {
    if (!pair.points[i]) continue;
    reference_keypoints_.push_back(keypoints[i]);
    points_.push_back(*pair.points[i]);
  }
  views_ = {make_view(input_->reference, SE3()), make_view(input_->frames.size() - 1, pair.second_from_first)};
}

std::vector<int> InitialStructure::keypoints_in(size_t frame) const {
  if (frame == input_->reference) return reference_keypoints_;
  const std::vector<int>& found = input_->tracks.found()[frame - input_->reference - 1];
  std::vector<int> keypoints;
  keypoints.reserve(points_.size());
  for (int keypoint : reference_keypoints_) keypoints.push_back(found[keypoint]);
  return keypoints;
}

InitialStructure::View InitialStructure::make_view(size_t frame, const SE3& cam_from_reference) const {
  View view{frame, cam_from_reference, keypoints_in(frame), {}};
  for (int keypoint : view.keypoints) view.agrees.push_back(keypoint != kNone);
  return view;
}

BundleProblem::Observation InitialStructure::observation(size_t view, size_t point) const {
  const Features& features = *input_->frames[views_[view].frame].features;
  const int keypoint = views_[view].keypoints[point];
  return {static_cast<int>(view), static_cast<int>(point), features.undistorted[keypoint].cast<double>(),
          input_->octave_scales[features.keypoints[keypoint].octave]};
}

// Finds the frame's pose, starting from a neighbour's. Returns nullopt if fewer than 20, or fewer than half, of the
// observed points agree with it.
std::optional<SE3> InitialStructure::resect_frame(size_t frame, const SE3& neighbour) const {
  const std::vector<int> keypoints = keypoints_in(frame);
  const Features& features = *input_->frames[frame].features;
  const size_t step = std::max<size_t>(1, points_.size() / kMostPosePoints);
  std::vector<PointObservation> observations;
  for (size_t p = 0; p < points_.size(); p += step)
    if (keypoints[p] != kNone)
      observations.push_back({points_[p], features.undistorted[keypoints[p]].cast<double>(),
                              input_->octave_scales[features.keypoints[keypoints[p]].octave]});
  const PoseResult pose = optimize_pose(input_->camera, neighbour, observations);
  const bool enough = pose.converged && pose.inliers >= 20 && 2 * pose.inliers >= static_cast<int>(observations.size());
  return enough ? std::optional(pose.cam_from_submap) : std::nullopt;
}

Result<> InitialStructure::add_views_between() {
  const size_t last = input_->frames.size() - 1;
  const size_t step = std::max<size_t>(1, (last - input_->reference) / kMostBetween);
  size_t tried = 0;
  SE3 neighbour;
  for (size_t f = input_->reference + step; f < last; f += step) {
    ++tried;
    const auto pose = resect_frame(f, neighbour);
    if (!pose) continue;
    neighbour = *pose;
    views_.push_back(make_view(f, *pose));
  }
  const size_t agreeing = views_.size() - 2;
  if (2 * agreeing < tried) return Error{fmt::format("only {} of {} frames between agree", agreeing, tried)};
  return {};
}

BundleProblem InitialStructure::as_it_is() const {
  BundleProblem problem;
  problem.points = points_;
  for (const View& view : views_) problem.views.push_back({view.cam_from_reference, false});
  return problem;
}

double InitialStructure::error_px() const {
  const BundleProblem problem = as_it_is();
  double sum = 0;
  size_t count = 0;
  for (size_t v = 0; v < views_.size(); ++v)
    for (size_t p = 0; p < points_.size(); ++p) {
      if (views_[v].keypoints[p] == kNone) continue;
      sum += std::min(kOutlierChi2, reprojection_chi2(input_->camera, problem, observation(v, p)));
      ++count;
    }
  return std::sqrt(sum / static_cast<double>(std::max<size_t>(1, count)));
}

// Adjusts all views and the chosen points. Returns false if they cannot be adjusted.
bool InitialStructure::solve(const std::vector<size_t>& chosen, int iterations) {
  BundleProblem problem;
  for (const View& view : views_) problem.views.push_back({view.cam_from_reference, problem.views.empty()});
  for (size_t p : chosen) problem.points.push_back(points_[p]);
  for (size_t v = 0; v < views_.size(); ++v)
    for (size_t i = 0; i < chosen.size(); ++i) {
      if (!views_[v].agrees[chosen[i]]) continue;
      BundleProblem::Observation o = observation(v, chosen[i]);
      o.point = static_cast<int>(i);
      if (std::isfinite(reprojection_chi2(input_->camera, problem, o))) problem.observations.push_back(o);
    }
  if (!solve_bundle(input_->camera, {iterations}, &problem).usable) return false;
  for (size_t v = 0; v < views_.size(); ++v) views_[v].cam_from_reference = problem.views[v].cam_from_submap;
  for (size_t i = 0; i < chosen.size(); ++i) points_[chosen[i]] = problem.points[i];
  return true;
}

void InitialStructure::sort_out() {
  const BundleProblem problem = as_it_is();
  for (size_t v = 0; v < views_.size(); ++v)
    for (size_t p = 0; p < points_.size(); ++p)
      views_[v].agrees[p] = views_[v].keypoints[p] != kNone &&
                            reprojection_chi2(input_->camera, problem, observation(v, p)) <= kOutlierChi2;
}

Result<> InitialStructure::adjust() {
  std::vector<size_t> chosen;
  std::vector<bool> solved(points_.size(), false);
  const size_t wanted = std::min(points_.size(), kMostBundlePoints);
  for (size_t i = 0; i < wanted; ++i) chosen.push_back(i * points_.size() / wanted);
  for (size_t p : chosen) solved[p] = true;
  if (!solve(chosen, 15)) return Error{"the first bundle adjustment failed"};
  sort_out();
  solve(chosen, 15);
  for (size_t p = 0; p < points_.size(); ++p) {
    if (solved[p]) continue;
    const auto point = triangulate(views_[0].cam_from_reference, input_->camera.ray(observation(0, p).pixel),
                                   views_[1].cam_from_reference, input_->camera.ray(observation(1, p).pixel));
    if (point) points_[p] = *point;
  }
  sort_out();

  int in_both = 0;
  for (size_t p = 0; p < points_.size(); ++p) in_both += views_[0].agrees[p] && views_[1].agrees[p];
  if (in_both < input_->options.two_view.min_points)
    return Error{fmt::format("{} points left after bundle adjustment", in_both)};
  return {};
}

double InitialStructure::direction_sigma_rad() const {
  const SE3& last = views_[1].cam_from_reference;
  FreeStructure structure;
  for (const View& view : views_) structure.cam_from_structure.push_back(view.cam_from_reference);
  const size_t step = std::max<size_t>(1, points_.size() / kMostBundlePoints);
  for (size_t p = 0; p < points_.size(); p += step) {
    FreeStructure::Point point{points_[p], {}};
    for (size_t v = 0; v < views_.size(); ++v)
      if (views_[v].agrees[p]) point.sights.push_back({v, observation(v, p).sigma_px / std::sqrt(step)});
    if (point.sights.size() >= 2) structure.points.push_back(std::move(point));
  }
  const Eigen::Matrix3d covariance = position_covariance(last, second_twist_covariance(input_->camera, structure));
  return std::sqrt(covariance.trace()) / last.center().norm();
}

bool InitialStructure::same_as(const InitialStructure& other) const {
  constexpr double kRotationRad = 0.02, kDirectionRad = 0.15;
  const SE3 &a = views_[1].cam_from_reference, &b = other.views_[1].cam_from_reference;
  const double cosine = a.translation.normalized().dot(b.translation.normalized());
  return (a * b.inverse()).angle_rad() < kRotationRad && cosine > std::cos(kDirectionRad);
}

InitialMap InitialStructure::finish() const {
  std::vector<double> depths;
  for (const Eigen::Vector3d& p : points_) depths.push_back(p.z());
  const Sim3 unit_from_reference(1.0 / median(&depths), Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero());

  InitialMap map;
  // The two ends and an even choice of the views between become keyframes; the other views only give their poses.
  const size_t between = views_.size() - 2;
  const size_t wanted = std::min<size_t>(between, std::max(0, input_->options.max_keyframes - 2));
  for (size_t v = 0; v < views_.size(); ++v) {
    const size_t i = v - 2;
    const bool keyframe = v < 2 || (i * wanted / between != (i + 1) * wanted / between);
    map.views.push_back(
        {views_[v].frame, unit_from_reference.transform_camera(views_[v].cam_from_reference), keyframe});
  }
  for (size_t p = 0; p < points_.size(); ++p) {
    InitialMap::Point point{unit_from_reference * points_[p], {}};
    for (size_t v = 0; v < views_.size(); ++v)
      if (map.views[v].keyframe && views_[v].agrees[p]) point.observations.emplace_back(v, views_[v].keypoints[p]);
    if (point.observations.size() >= 2) map.points.push_back(std::move(point));
  }
  // Frames that are not views get poses too.
  std::vector<std::optional<SE3>> pose(input_->frames.size());
  for (const View& view : views_) pose[view.frame] = view.cam_from_reference;
  for (size_t f = input_->reference + 1; f < input_->frames.size(); ++f) {
    if (pose[f] || !pose[f - 1]) continue;
    pose[f] = resect_frame(f, *pose[f - 1]);
    if (pose[f]) map.views.push_back({f, unit_from_reference.transform_camera(*pose[f]), false});
  }
  return map;
}

}  // namespace rumi::front_tracker
