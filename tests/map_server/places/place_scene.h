// SPDX-License-Identifier: BSD-3-Clause
// A world of points with descriptors, and submaps of it, each in its own gauge and with noise in pixels, descriptors
// and landmarks.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <random>
#include <vector>

#include "slam/map/submap.h"
#include "tests/slam/synthetic_scene.h"

namespace rumi::map_server {

struct ScenePoint {
  Eigen::Vector3d position;
  Descriptor descriptor;
  int name = kNone;  // identifies the point in several submaps and worlds
};

class PlaceScene {
 public:
  explicit PlaceScene(unsigned seed) : scene_(seed), rng_(seed + 1000) {}

  Descriptor descriptor() { return {rng_(), rng_(), rng_(), rng_()}; }
  double uniform(double low, double high) { return scene_.uniform(low, high); }
  std::vector<ScenePoint> cloud(int count) {
    std::vector<ScenePoint> points;
    for (const Eigen::Vector3d& p : scene_.cloud(count)) points.push_back({p, descriptor(), next_name_++});
    return points;
  }
  // Returns a random gauge with this scale.
  Sim3 gauge(double scale) {
    return {scale, so3_exp({uniform(-2, 2), uniform(-2, 2), uniform(-2, 2)}),
            scale * Eigen::Vector3d(uniform(-9, 9), uniform(-9, 9), uniform(-9, 9))};
  }
  // Returns nine cameras along a short path, which look at the cloud.
  std::vector<SE3> path(double x, double y, double z, double yaw_rad = 0) {
    std::vector<SE3> cameras;
    for (int i = -4; i <= 4; ++i)
      cameras.push_back(SyntheticScene::pose(x + 0.08 * i, y + 0.02 * i, z + 0.03 * i, yaw_rad - 0.01 * i, 0.01 * i));
    return cameras;
  }

  // Makes a submap with keyframes 1, 2, ... a second apart. Its landmarks are the points that at least two keyframes
  // see, with a noise of 0.5 %. `names`, if given, receives the name of each landmark's point.
  Submap submap(SubmapKey key, const std::vector<ScenePoint>& points, const std::vector<SE3>& cams_from_world,
                const Sim3& submap_from_world, std::map<int, int>* names = nullptr) {
    Submap s;
    s.key = key;
    s.camera = test_camera();
    s.revision = 1;
    std::vector<std::vector<Observation>> seen(points.size());
    for (const SE3& cam_from_world : cams_from_world) {
      const int id = static_cast<int>(s.keyframes.size()) + 1;
      Keyframe& keyframe = s.keyframes[id];
      keyframe.id = id;
      keyframe.utime_us = 1'000'000 * id;
      keyframe.cam_from_submap = submap_from_world.transform_camera(cam_from_world);
      auto features = std::make_shared<Features>();
      for (size_t p = 0; p < points.size(); ++p)
        if (see(points[p], cam_from_world, s.camera, features.get()))
          seen[p].push_back({id, static_cast<int>(features->size()) - 1});
      for (int i = 0; i < 100; ++i) add({uniform(5, 630), uniform(5, 470)}, descriptor(), 0, features.get());
      features->undistort(s.camera);
      keyframe.landmark_ids.assign(features->size(), kNone);
      keyframe.features = features;
    }
    const Eigen::Vector3d middle = cams_from_world[cams_from_world.size() / 2].center();
    for (size_t p = 0; p < points.size(); ++p) {
      if (seen[p].size() < 2) continue;
      const int id = static_cast<int>(s.landmarks.size()) + 1;
      const double stretch = 1 + 0.01 * uniform(-0.5, 0.5);
      s.landmarks[id].id = id;
      s.landmarks[id].position = submap_from_world * (middle + stretch * (points[p].position - middle));
      for (const Observation& o : seen[p]) s.add_observation(id, o.keyframe_id, o.keypoint_index);
      if (names) (*names)[id] = points[p].name;
    }
    return s;
  }

 private:
  // Adds a keypoint if the point is in view, but leaves out one in five at random. A point 4 units away is of octave 3.
  bool see(const ScenePoint& point, const SE3& cam_from_world, const Camera& camera, Features* features) {
    const Eigen::Vector3d in_cam = cam_from_world * point.position;
    const auto pixel = camera.project(in_cam);
    const int octave = static_cast<int>(std::lround(3 + std::log(4 / in_cam.norm()) / std::log(1.2)));
    if (!pixel || !camera.contains(*pixel, 5) || octave < 0 || octave > 7 || uniform(0, 1) > 0.8) return false;
    add(*pixel + scene_.noise(0.5 * std::pow(1.2, octave)), point.descriptor, octave, features);
    return true;
  }
  void add(const Eigen::Vector2d& pixel, Descriptor d, int octave, Features* features) {
    for (int i = 0; i < 12; ++i) {
      const auto bit = rng_() % 256;
      d[bit / 64] ^= uint64_t{1} << (bit % 64);
    }
    features->keypoints.push_back({pixel.cast<float>(), 0, static_cast<uint8_t>(octave)});
    features->descriptors.push_back(d);
  }

  SyntheticScene scene_;
  std::mt19937_64 rng_;
  int next_name_ = 0;
};

}  // namespace rumi::map_server
