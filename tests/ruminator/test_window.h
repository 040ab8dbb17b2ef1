// SPDX-License-Identifier: BSD-3-Clause
// Keypoints and matches of a window whose truth is known.
#pragma once

#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "ruminator/colmap/colmap_database.h"
#include "ruminator/colmap/read_model.h"
#include "slam/geometry/alignment.h"
#include "tests/slam/synthetic_scene.h"

namespace rumi::testing {
using namespace rumi::ruminator;

struct TestWindow {
  Camera camera = test_camera();
  std::vector<SE3> cam_from_world;
  std::vector<Eigen::Vector3d> points;
  std::vector<WindowImage> images;
  std::vector<std::vector<int>> point_of_keypoint;  // index of the point: [image][keypoint], ascending
  std::vector<ImagePair> pairs;
};

// Makes a keypoint of every point that a camera sees, and a pair of any two images that have at least 30 points in
// common.
inline TestWindow make_window(const std::vector<SE3>& cam_from_world, const std::vector<Eigen::Vector3d>& points,
                              double noise_px, unsigned seed = 1) {
  constexpr size_t kMinCommon = 30;
  TestWindow w;
  w.cam_from_world = cam_from_world;
  w.points = points;
  SyntheticScene random(seed);
  for (const SE3& pose : cam_from_world) {
    WindowImage& image = w.images.emplace_back();
    image.name = std::to_string(w.images.size());
    std::vector<int>& of_keypoint = w.point_of_keypoint.emplace_back();
    for (size_t p = 0; p < points.size(); ++p) {
      const Eigen::Vector3d in_camera = pose * points[p];
      if (in_camera.z() < 0.2) continue;
      const Eigen::Vector2d pixel = w.camera.project_undistorted(in_camera) + random.noise(noise_px);
      if (!w.camera.contains(pixel)) continue;
      image.keypoints.push_back(pixel.cast<float>());
      of_keypoint.push_back(static_cast<int>(p));
    }
  }
  for (size_t a = 0; a < w.images.size(); ++a) {
    for (size_t b = a + 1; b < w.images.size(); ++b) {
      ImagePair pair{static_cast<int>(a), static_cast<int>(b), {}};
      const std::vector<int>&of_a = w.point_of_keypoint[a], &of_b = w.point_of_keypoint[b];
      for (size_t i = 0, j = 0; i < of_a.size() && j < of_b.size();) {
        if (of_a[i] == of_b[j])
          pair.matches.emplace_back(i++, j++);
        else
          of_a[i] < of_b[j] ? ++i : ++j;
      }
      if (pair.matches.size() >= kMinCommon) w.pairs.push_back(std::move(pair));
    }
  }
  return w;
}

// Gives matches wrong partners: the share `match_fraction` of the matches of each pair. In the share `pair_fraction` of
// the pairs it spoils all matches and leaves only a few, as in wrong pairs that pass the verification.
inline void spoil(TestWindow* w, double match_fraction, double pair_fraction, unsigned seed = 2) {
  constexpr size_t kWeak = 25;
  SyntheticScene random(seed);
  for (ImagePair& pair : w->pairs) {
    const bool is_wrong = random.uniform(0, 1) < pair_fraction;
    if (is_wrong) pair.matches.resize(std::min(pair.matches.size(), kWeak));
    const double fraction = is_wrong ? 1.0 : match_fraction;
    std::vector<size_t> wrong;
    for (size_t i = 0; i < pair.matches.size(); ++i)
      if (random.uniform(0, 1) < fraction) wrong.push_back(i);
    for (size_t i = 1; i < wrong.size(); ++i) {
      const auto j = static_cast<size_t>(random.uniform(0, static_cast<double>(i)));
      std::swap(pair.matches[wrong[i]].second, pair.matches[wrong[j]].second);
    }
  }
}

// Returns a path on which the camera moves sideways past a cloud of points.
inline std::vector<SE3> sideways_path(int cameras, double step = 0.1) {
  std::vector<SE3> path;
  for (int i = 0; i < cameras; ++i) {
    const double u = i - 0.5 * (cameras - 1);
    path.push_back(SyntheticScene::pose(step * u, 0.03 * std::sin(0.7 * u), 0.05 * std::sin(0.4 * u),
                                        0.02 * std::sin(u), 0.01 * u));
  }
  return path;
}

inline TestWindow sideways_window(int cameras, double noise_px = 0.7, int points = 500) {
  return make_window(sideways_path(cameras), SyntheticScene(7).cloud(points), noise_px);
}

// Makes a window in which the camera moves in the middle of a round room and turns fast.
inline TestWindow turning_window(int cameras, double turn_deg_per_frame = 16, double noise_px = 0.7) {
  SyntheticScene random(3);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 1800; ++i) {
    const double angle = random.uniform(-M_PI, M_PI), radius = random.uniform(2, 5);
    points.emplace_back(radius * std::sin(angle), 0.35 * radius * random.uniform(-1, 1), radius * std::cos(angle));
  }
  std::vector<SE3> path;
  for (int i = 0; i < cameras; ++i) {
    const double u = i - 0.5 * (cameras - 1);
    path.push_back(SyntheticScene::pose(0.12 * u, 0.05 * std::sin(0.9 * u), 0.3 * std::sin(0.35 * u),
                                        turn_deg_per_frame * u * M_PI / 180, 0.03 * std::sin(u)));
  }
  return make_window(path, points, noise_px);
}

inline double path_length(const std::vector<SE3>& cam_from_world) {
  double length = 0;
  for (size_t i = 1; i < cam_from_world.size(); ++i)
    length += (cam_from_world[i].center() - cam_from_world[i - 1].center()).norm();
  return length;
}

// Returns the largest position error of a camera after alignment, over the length of the true path.
inline double worst_center_error(const TestWindow& w, const SparseModel& model) {
  std::vector<Eigen::Vector3d> found, truth;
  for (const auto& [image, pose] : model.cam_from_world) {
    found.push_back(pose.center());
    truth.push_back(w.cam_from_world[image].center());
  }
  const auto truth_from_found = umeyama(found, truth);
  if (!truth_from_found) return std::numeric_limits<double>::infinity();
  double worst = 0;
  for (size_t i = 0; i < found.size(); ++i) worst = std::max(worst, (*truth_from_found * found[i] - truth[i]).norm());
  return worst / path_length(w.cam_from_world);
}

// Returns the true model: the poses of all images, and the points that at least two of them see.
inline SparseModel true_model(const TestWindow& w) {
  SparseModel model;
  model.fx = w.camera.fx;
  model.fy = w.camera.fy;
  std::vector<SparseModel::Point> points(w.points.size());
  for (size_t p = 0; p < points.size(); ++p) points[p].position = w.points[p];
  for (size_t image = 0; image < w.images.size(); ++image) {
    model.cam_from_world[static_cast<int>(image)] = w.cam_from_world[image];
    for (size_t k = 0; k < w.point_of_keypoint[image].size(); ++k)
      points[w.point_of_keypoint[image][k]].track.emplace_back(image, k);
  }
  for (SparseModel::Point& point : points)
    if (point.track.size() >= 2) model.points.push_back(std::move(point));
  return model;
}

inline bool sees_an_image_twice(const std::vector<std::pair<int, int>>& track) {
  std::set<int> images;
  for (const auto& [image, keypoint] : track)
    if (!images.insert(image).second) return true;
  return false;
}

inline bool is_identical(const SparseModel& a, const SparseModel& b) {
  if (a.cam_from_world.size() != b.cam_from_world.size() || a.points.size() != b.points.size()) return false;
  for (const auto& [image, pose] : a.cam_from_world) {
    const auto other = b.cam_from_world.find(image);
    if (other == b.cam_from_world.end() || pose.translation != other->second.translation ||
        pose.rotation.coeffs() != other->second.rotation.coeffs())
      return false;
  }
  for (size_t p = 0; p < a.points.size(); ++p)
    if (a.points[p].position != b.points[p].position || a.points[p].track != b.points[p].track) return false;
  return true;
}

}  // namespace rumi::testing
