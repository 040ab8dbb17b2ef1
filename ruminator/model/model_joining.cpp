// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/model/model_joining.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "slam/geometry/alignment.h"
#include "slam/geometry/rotation_fit.h"
#include "slam/numeric/consensus.h"

namespace rumi::ruminator {
namespace {

constexpr int kMinPoints = 15;     // least number of points that both models place alike
constexpr double kMinShare = 0.5;  // least share of these among all points in common
constexpr double kMaxErrorPx = 6;  // largest mean error of a point in the images of the other model, both ways
constexpr int kSamples = 500;      // most samples of three points in the search for the transform
// Limits for front_tracker's poses to tie two models: see FrontAgreement.
constexpr double kFrontMaxPositionRatio = 0.1;
constexpr double kFrontMaxRotationDeg = 5;

using PointOf = std::map<std::pair<int, int>, const SparseModel::Point*>;  // by an observation: (image, keypoint)

PointOf points_by_keypoint(const SparseModel& model) {
  PointOf points;
  for (const SparseModel::Point& point : model.points)
    for (const auto& observation : point.track) points[observation] = &point;
  return points;
}

const SparseModel::Point* point_of_track(const PointOf& points, const Track& track) {
  for (const auto& observation : track)
    if (const auto found = points.find(observation); found != points.end()) return found->second;
  return nullptr;
}

// Returns the mean reprojection error of a position in the images that see the point; infinite if it is behind one.
double mean_error_px(const Camera& camera, const std::vector<WindowImage>& images, const SparseModel& model,
                     const SparseModel::Point& point, const Eigen::Vector3d& position) {
  double sum = 0;
  for (const auto& [image, keypoint] : point.track) {
    const Eigen::Vector3d in_camera = model.cam_from_world.at(image) * position;
    if (in_camera.z() <= 0) return std::numeric_limits<double>::infinity();
    sum += (camera.project_undistorted(in_camera) - images[image].keypoints[keypoint].cast<double>()).norm();
  }
  return sum / static_cast<double>(point.track.size());
}

struct Common {
  const SparseModel::Point *a = nullptr, *b = nullptr;
};

template <class Indices>
std::optional<Sim3> fit(const std::vector<Common>& common, const Indices& those) {
  std::vector<Eigen::Vector3d> a, b;
  for (const int i : those) {
    a.push_back(common[i].a->position);
    b.push_back(common[i].b->position);
  }
  auto a_from_b = umeyama(b, a);
  if (a_from_b && !(a_from_b->is_finite() && a_from_b->scale > 0)) a_from_b.reset();
  return a_from_b;
}

struct FrontPose {
  SE3 cam_from_submap, cam_from_model;
};

// Returns the alignment of the camera centres, with a rotation taken from the poses, because centres on a line would
// not determine it: the frame's rotation from which those of the other frames differ least.
std::optional<Sim3> submap_from_model(const std::vector<FrontPose>& poses) {
  std::vector<Eigen::Vector3d> in_model, in_submap;
  std::vector<Eigen::Quaterniond> rotations;
  Eigen::Vector3d mean_in_model = Eigen::Vector3d::Zero(), mean_in_submap = Eigen::Vector3d::Zero();
  for (const FrontPose& p : poses) {
    in_model.push_back(p.cam_from_model.center());
    in_submap.push_back(p.cam_from_submap.center());
    mean_in_model += in_model.back() / static_cast<double>(poses.size());
    mean_in_submap += in_submap.back() / static_cast<double>(poses.size());
    rotations.push_back(p.cam_from_submap.rotation.conjugate() * p.cam_from_model.rotation);
  }
  const auto aligned = umeyama(in_model, in_submap);
  if (!aligned || aligned->scale <= 0) return std::nullopt;
  const Eigen::Quaterniond rotation = central_rotation(rotations);
  return Sim3(aligned->scale, rotation, mean_in_submap - aligned->scale * (rotation * mean_in_model));
}

// Returns a transform for each front submap with which the model agrees.
std::map<int32_t, Sim3> submaps_from_model(const std::vector<Sample>& front, const std::vector<int64_t>& utimes_us,
                                           const SparseModel& model) {
  std::map<int64_t, SE3> cam_from_model;
  for (const auto& [image, pose] : model.cam_from_world) cam_from_model[utimes_us[image]] = pose;
  std::map<int32_t, Sim3> submaps;
  for (const FrontAgreement& a : compare_with_front(front, cam_from_model)) {
    if (a.rotation_deg > kFrontMaxRotationDeg || a.position_ratio > kFrontMaxPositionRatio) continue;
    std::vector<FrontPose> poses;
    for (const Sample& sample : front)
      if (const auto pose = cam_from_model.find(sample.utime_us);
          sample.submap_id == a.submap_id && pose != cam_from_model.end())
        poses.push_back({sample.cam_from_submap, pose->second});
    if (const auto transform = submap_from_model(poses)) submaps[a.submap_id] = *transform;
  }
  return submaps;
}

}  // namespace

std::optional<Sim3> align_models(const Camera& camera, const std::vector<WindowImage>& images,
                                 const std::vector<Track>& tracks, const SparseModel& a, const SparseModel& b) {
  const PointOf points_a = points_by_keypoint(a), points_b = points_by_keypoint(b);
  std::vector<Common> common;
  for (const Track& track : tracks) {
    const Common c{point_of_track(points_a, track), point_of_track(points_b, track)};
    if (c.a && c.b) common.push_back(c);
  }
  if (static_cast<int>(common.size()) < kMinPoints) return std::nullopt;
  const auto agreeing = [&](const Sim3& a_from_b) {
    const Sim3 b_from_a = a_from_b.inverse();
    std::vector<int> members;
    for (int i = 0; i < static_cast<int>(common.size()); ++i)
      if (mean_error_px(camera, images, a, *common[i].a, a_from_b * common[i].b->position) <= kMaxErrorPx &&
          mean_error_px(camera, images, b, *common[i].b, b_from_a * common[i].a->position) <= kMaxErrorPx)
        members.push_back(i);
    return members;
  };
  const auto found = find_consensus_of_three(
      common.size(), {.samples = kSamples}, [&](const std::array<int, 3>& sample) { return fit(common, sample); },
      agreeing);
  if (!found) return std::nullopt;
  std::vector<int> best = found->members;
  for (int round = 0; round < 3 && best.size() >= 3; ++round)
    if (const auto better = fit(common, best)) best = agreeing(*better);
  if (static_cast<int>(best.size()) < kMinPoints ||
      static_cast<double>(best.size()) < kMinShare * static_cast<double>(common.size()))
    return std::nullopt;
  return fit(common, best);
}

SparseModel join_models(const Sim3& a_from_b, const SparseModel& a, const SparseModel& b) {
  SparseModel joined = a;
  joined.points.clear();
  for (const auto& [image, pose] : b.cam_from_world)
    joined.cam_from_world.try_emplace(image, a_from_b.transform_camera(pose));
  return joined;
}

std::optional<Sim3> front_tie(const std::vector<Sample>& front, const std::vector<int64_t>& utimes_us,
                              const SparseModel& before, const SparseModel& after) {
  const auto from_before = submaps_from_model(front, utimes_us, before);
  const auto from_after = submaps_from_model(front, utimes_us, after);
  for (const auto& [submap_id, submap_from_before] : from_before)
    if (const auto other = from_after.find(submap_id); other != from_after.end())
      return submap_from_before.inverse() * other->second;
  return std::nullopt;
}

}  // namespace rumi::ruminator
