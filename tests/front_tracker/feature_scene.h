// SPDX-License-Identifier: BSD-3-Clause
// A world of points with descriptors. Gives what a camera at a known pose sees of them, without rendering anything.
#pragma once

#include <random>

#include "front_tracker/frame/front_submap.h"
#include "slam/features/orb_extractor.h"
#include "slam/map/landmark_view.h"
#include "tests/slam/synthetic_scene.h"

namespace rumi::front_tracker {

inline std::vector<double> test_octave_scales() { return Pyramid().scales(); }

class FeatureScene {
 public:
  explicit FeatureScene(unsigned seed, int points = 600) : scene_(seed), rng_(seed + 1000) {
    points_ = scene_.cloud(points);
    for (int i = 0; i < points; ++i) descriptors_.push_back({rng_(), rng_(), rng_(), rng_()});
  }
  std::vector<Eigen::Vector3d>& points() { return points_; }

  // Returns a frame with every point in view as a keypoint at octave 0, with half a pixel of noise and ten wrong bits,
  // among some clutter. point_of, if given, receives the point of each keypoint (kNone for clutter).
  Frame frame(int64_t utime_us, const SE3& cam_from_world, std::vector<int>* point_of = nullptr) {
    Features features;
    std::vector<int> source;
    const auto add = [&](const Eigen::Vector2d& pixel, Descriptor d, int point) {
      for (int i = 0; i < 10; ++i) {
        const auto bit = rng_() % 256;
        d[bit / 64] ^= uint64_t{1} << (bit % 64);
      }
      features.keypoints.push_back({pixel.cast<float>(), 0, 0});
      features.descriptors.push_back(d);
      source.push_back(point);
    };
    for (size_t i = 0; i < points_.size(); ++i) {
      const auto pixel = camera_.project(cam_from_world * points_[i]);
      if (pixel && camera_.contains(*pixel, 5)) add(*pixel + scene_.noise(0.5), descriptors_[i], static_cast<int>(i));
    }
    for (int i = 0; i < 100; ++i)
      add({scene_.uniform(5, 630), scene_.uniform(5, 470)}, {rng_(), rng_(), rng_(), rng_()}, kNone);
    if (point_of) *point_of = source;
    return make_frame(utime_us, std::move(features), camera_);
  }

  // Returns a true submap: keyframes at the poses, and landmarks at the points that at least two of them see.
  std::unique_ptr<FrontSubmap> submap(const std::vector<SE3>& poses) {
    auto s = std::make_unique<FrontSubmap>();
    s->map.key = {1, 1};
    s->map.camera = camera_;
    s->map.revision = 1;
    s->octave_scales = test_octave_scales();
    std::vector<std::vector<std::pair<int, int>>> seen(points_.size());
    for (size_t v = 0; v < poses.size(); ++v) {
      std::vector<int> point_of;
      Frame f = frame(static_cast<int64_t>(100'000 * (v + 1)), poses[v], &point_of);
      f.cam_from_submap = poses[v];
      const int id = s->add_keyframe(&f).id;
      s->map.frames.set({f.utime_us, id, SE3(), 1});
      for (size_t k = 0; k < point_of.size(); ++k)
        if (point_of[k] != kNone) seen[point_of[k]].emplace_back(id, static_cast<int>(k));
    }
    for (size_t p = 0; p < points_.size(); ++p) {
      if (seen[p].size() < 2) continue;
      const int id = s->add_landmark(points_[p]).id;
      for (const auto& [kf, keypoint] : seen[p]) s->map.add_observation(id, kf, keypoint);
      update_landmark_view(s->map, s->map.landmark(id));
    }
    return s;
  }

 private:
  Camera camera_ = test_camera();
  SyntheticScene scene_;
  std::mt19937_64 rng_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<Descriptor> descriptors_;
};

}  // namespace rumi::front_tracker
