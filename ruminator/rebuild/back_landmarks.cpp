// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/rebuild/back_landmarks.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/running/stage_clock.h"
#include "ruminator/model/model_refinement.h"
#include "slam/features/descriptor.h"
#include "slam/geometry/epipolar.h"
#include "slam/map/landmark_view.h"
#include "slam/numeric/median.h"
#include "slam/optimization/bundle_adjustment.h"

namespace rumi::ruminator {
namespace {

constexpr size_t kNeighbours = 10;  // each image is matched with this many others, those that share most points with it
constexpr int kMaxDistance = 50;    // largest Hamming distance of a match
constexpr double kMaxLinePx = 2;    // largest distance of a match from its epipolar line, at octave 0

double median_depth(const SparseModel& model) {
  std::vector<double> depths;
  for (const SparseModel::Point& point : model.points)
    for (const auto& [image, keypoint] : point.track)
      depths.push_back((model.cam_from_world.at(image) * point.position).z());
  if (depths.empty()) return 1;
  return median(&depths);
}

// Returns pairs of images: each image with those that share most points with it.
std::set<std::pair<int, int>> neighbouring_images(const SparseModel& model) {
  std::map<int, std::map<int, int>> shared;
  for (const SparseModel::Point& point : model.points)
    for (const auto& a : point.track)
      for (const auto& b : point.track)
        if (a.first != b.first) ++shared[a.first][b.first];
  std::set<std::pair<int, int>> pairs;
  for (const auto& [image, others] : shared) {
    std::vector<std::pair<int, int>> best;  // (minus the points in common, other image)
    for (const auto& [other, count] : others) best.emplace_back(-count, other);
    std::sort(best.begin(), best.end());
    for (size_t i = 0; i < best.size() && i < kNeighbours; ++i) pairs.insert(std::minmax(image, best[i].second));
  }
  return pairs;
}

struct Nearest {
  int index = kNone;
  int distance = 0;
};

// Returns for each keypoint of `a` the most similar keypoint of `b` near its epipolar line.
std::vector<Nearest> nearest_on_lines(const Features& a, const Features& b, const Eigen::Matrix3f& f,
                                      const std::vector<double>& scales) {
  std::vector<float> width;  // largest distance from the line, by keypoint of b
  for (const Keypoint& k : b.keypoints) width.push_back(static_cast<float>(kMaxLinePx * scales[k.octave]));
  std::vector<Nearest> nearest(a.size());
  for (size_t i = 0; i < a.size(); ++i) {
    Eigen::Vector3f line = f * Eigen::Vector3f(a.undistorted[i].x(), a.undistorted[i].y(), 1);
    line /= line.head<2>().norm();
    Nearest& best = nearest[i];
    best.distance = kMaxDistance + 1;
    for (size_t j = 0; j < b.size(); ++j) {
      const Eigen::Vector2f& p = b.undistorted[j];
      if (std::abs(line.x() * p.x() + line.y() * p.y() + line.z()) > width[j]) continue;
      const int distance = hamming_distance(a.descriptors[i], b.descriptors[j]);
      if (distance < best.distance) best = {static_cast<int>(j), distance};
    }
  }
  return nearest;
}

ImagePair match_along_lines(const Camera& camera, const Keyframe& a, const Keyframe& b,
                            const std::vector<double>& scales) {
  const SE3 b_from_a = b.cam_from_submap * a.cam_from_submap.inverse();
  const Eigen::Matrix3f f = fundamental_matrix(camera, b_from_a).cast<float>();
  const auto forth = nearest_on_lines(*a.features, *b.features, f, scales);
  const auto back = nearest_on_lines(*b.features, *a.features, f.transpose(), scales);
  ImagePair pair{a.id, b.id, {}};
  for (size_t i = 0; i < forth.size(); ++i)
    if (forth[i].index != kNone && back[forth[i].index].index == static_cast<int>(i))
      pair.matches.emplace_back(static_cast<int>(i), forth[i].index);
  return pair;
}

// Optimizes the positions of the points with fixed poses.
void adjust_points(const Camera& camera, const std::vector<WindowImage>& images, SparseModel* model) {
  BundleProblem problem;
  for (const auto& [image, pose] : model->cam_from_world) problem.views.push_back({pose, true});
  for (const SparseModel::Point& point : model->points) {
    for (const auto& [image, keypoint] : point.track)
      problem.observations.push_back(
          {image, static_cast<int>(problem.points.size()), images[image].keypoints[keypoint].cast<double>(), 1.0});
    problem.points.push_back(point.position);
  }
  if (!solve_bundle(camera, {}, &problem).usable) return;
  for (size_t p = 0; p < model->points.size(); ++p) model->points[p].position = problem.points[p];
}

void add_landmarks(const std::vector<SparseModel::Point>& points, Submap* submap) {
  for (const SparseModel::Point& point : points) {
    Landmark& landmark = submap->add_landmark(static_cast<int>(submap->landmarks.size()), point.position);
    for (const auto& [keyframe, keypoint] : point.track) submap->add_observation(landmark.id, keyframe, keypoint);
    update_landmark_view(*submap, &landmark);
  }
}

}  // namespace

void fill_back_submap(const Camera& camera, const std::vector<SeenImage>& images, const SparseModel& model,
                      Submap* submap) {
  const StageClock clock("ruminator.landmarks");
  const double unit = median_depth(model);
  OrbOptions orb;
  orb.pyramid = submap->pyramid;
  OrbExtractor extractor(orb);
  const std::vector<double> scales = submap->pyramid.scales();
  std::map<int, int> keyframe_of;  // index of the keyframe, by image
  std::vector<WindowImage> keypoints;
  SparseModel posed;
  for (const auto& [image, pose] : model.cam_from_world) {
    Keyframe keyframe;
    keyframe.id = keyframe_of[image] = static_cast<int>(keyframe_of.size());
    const SeenImage& seen = images[image];
    keyframe.utime_us = seen.utime_us;
    keyframe.cam_from_submap = SE3(pose.rotation, pose.translation / unit);
    auto features = std::make_shared<Features>(extractor.extract(extractor.pyramid(seen.grey, seen.mask)));
    features->undistort(camera);
    keypoints.push_back({"", {features->undistorted.begin(), features->undistorted.end()}});
    keyframe.features = std::move(features);
    posed.cam_from_world[keyframe.id] = keyframe.cam_from_submap;
    submap->set_frame({keyframe.utime_us, keyframe.id, SE3()});
    submap->add_keyframe(std::move(keyframe));
  }
  std::vector<ImagePair> pairs;
  for (const auto& [a, b] : neighbouring_images(model))
    pairs.push_back(
        match_along_lines(camera, *submap->keyframe(keyframe_of.at(a)), *submap->keyframe(keyframe_of.at(b)), scales));
  triangulate_tracks(camera, keypoints, join_tracks(keypoints, pairs), ModelRefinementOptions(), &posed);
  adjust_points(camera, keypoints, &posed);
  add_landmarks(posed.points, submap);
}

}  // namespace rumi::ruminator
