// SPDX-License-Identifier: BSD-3-Clause
// Makes submaps by random changes, of the kinds that front_tracker and map_server make.
#pragma once

#include <memory>
#include <random>

#include "slam/map/submap.h"

namespace rumi {

inline Camera test_camera() {
  Camera c;
  c.width = 640, c.height = 480;
  c.fx = 500.25, c.fy = 501.5, c.cx = 319.5, c.cy = 240.125;
  c.k1 = -0.1;
  return c;
}

// Makes random changes to a submap, each with a revision of its own.
class SubmapEditor {
 public:
  explicit SubmapEditor(unsigned seed) : random_(seed) {
    submap.key = {1234567, 1};
    submap.camera = test_camera();
    add_keyframe();
  }

  void edit() {
    switch (number(12)) {
      case 0:
      case 1:
        add_keyframe();
        break;
      case 2:
      case 3:
        add_landmark();
        break;
      case 4:
      case 5:
      case 6:
        observe();
        break;
      case 7:
        move();
        break;
      case 8:
        add_frame();
        break;
      case 9:
        forget();
        break;
      case 10:
        remove_keyframe();
        break;
      default:
        remove_or_fuse_landmark();
        break;
    }
  }

  Submap submap;

 private:
  int number(int below) { return static_cast<int>(random_() % static_cast<unsigned>(below)); }
  double real() { return std::uniform_real_distribution<double>(-1, 1)(random_); }
  SE3 pose() {
    return {Eigen::Quaterniond(2 + real(), real(), real(), real()), Eigen::Vector3d(real(), real(), real())};
  }
  Descriptor descriptor() {
    Descriptor d{};
    for (uint64_t& word : d) word = static_cast<uint64_t>(random_()) << 32 | random_();
    return d;
  }
  template <class Map>
  auto pick(const Map& map) {
    return std::next(map.begin(), number(static_cast<int>(map.size())))->first;
  }

  void add_keyframe() {
    ++submap.revision;
    auto features = std::make_shared<Features>();
    for (int i = 0, n = number(30); i < n; ++i) {
      const Eigen::Vector2d pixel(320 + 300 * real(), 240 + 200 * real());
      features->keypoints.push_back({pixel.cast<float>(), static_cast<float>(real()), static_cast<uint8_t>(number(8))});
      features->descriptors.push_back(descriptor());
    }
    Keyframe kf;
    kf.id = next_keyframe_++;
    kf.utime_us = next_utime_;
    kf.cam_from_submap = pose();
    kf.landmark_ids.assign(features->keypoints.size(), kNone);
    kf.features = features;
    kf.revision = kf.created_revision = submap.revision;
    submap.frames.set({next_utime_, kf.id, SE3(), submap.revision});
    next_utime_ += 33333;
    submap.keyframes[kf.id] = kf;
  }
  void add_frame() {
    ++submap.revision;
    submap.frames.set({next_utime_, pick(submap.keyframes), pose(), submap.revision});
    next_utime_ += 33333;
  }
  void add_landmark() {
    ++submap.revision;
    Landmark lm;
    lm.id = next_landmark_++;
    lm.position = 10 * Eigen::Vector3d(real(), real(), real());
    lm.descriptor = descriptor();
    lm.revision = submap.revision;
    submap.landmarks[lm.id] = lm;
  }
  void observe() {
    if (submap.landmarks.empty()) return;
    ++submap.revision;
    for (int i = 0; i < 8; ++i) submap.add_observation(pick(submap.landmarks), pick(submap.keyframes), number(30));
  }
  void move() {
    ++submap.revision;
    const int keyframe = pick(submap.keyframes);
    submap.move_keyframe(keyframe, pose());
    if (submap.landmarks.empty()) return;
    const int landmark = pick(submap.landmarks);
    submap.move_landmark(landmark, submap.landmark(landmark)->position + Eigen::Vector3d(real(), 0, 0));
  }
  void forget() {
    if (submap.landmarks.empty()) return;
    ++submap.revision;
    submap.remove_observation(pick(submap.landmarks), pick(submap.keyframes));
  }
  void remove_keyframe() {
    if (submap.keyframes.size() < 3) return;
    ++submap.revision;
    submap.remove_keyframe(pick(submap.keyframes), submap.keyframes.begin()->first);
  }
  void remove_or_fuse_landmark() {
    if (submap.landmarks.size() < 2) return;
    ++submap.revision;
    if (number(2))
      submap.remove_landmark(pick(submap.landmarks));
    else
      submap.fuse_landmarks(pick(submap.landmarks), pick(submap.landmarks));
  }

  std::mt19937 random_;
  int next_keyframe_ = 0, next_landmark_ = 0;
  int64_t next_utime_ = 1'000'000'000;
};

inline Submap random_submap(unsigned seed, int edits = 200) {
  SubmapEditor editor(seed);
  for (int i = 0; i < edits; ++i) editor.edit();
  return editor.submap;
}

}  // namespace rumi
