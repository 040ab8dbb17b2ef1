// SPDX-License-Identifier: BSD-3-Clause
// Makes the files of small COLMAP models.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "slam/geometry/transform.h"

namespace rumi::testing {
using namespace rumi::ruminator;

class Bytes {
 public:
  template <class T>
  Bytes& put(T value) {
    text.append(reinterpret_cast<const char*>(&value), sizeof(value));
    return *this;
  }
  Bytes& name(const std::string& value) {
    text += value + '\0';
    return *this;
  }
  std::string text;
};

struct TestImage {
  uint32_t id = 1;
  SE3 cam_from_world;
  int keypoints = 0;
};

struct TestPoint {
  uint64_t id = 1;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  std::vector<std::pair<uint32_t, uint32_t>> track;
};

struct TestModel {
  int32_t camera_model = 1;
  std::vector<double> parameters = {500, 510, 320, 240};
  std::vector<TestImage> images;
  std::vector<TestPoint> points;

  std::string cameras_bin() const {
    Bytes b;
    b.put<uint64_t>(1).put<uint32_t>(1).put(camera_model).put<uint64_t>(640).put<uint64_t>(480);
    for (const double p : parameters) b.put(p);
    return b.text;
  }
  std::string images_bin() const {
    Bytes b;
    b.put<uint64_t>(images.size());
    for (const TestImage& image : images) {
      const Eigen::Quaterniond& q = image.cam_from_world.rotation;
      const Eigen::Vector3d& t = image.cam_from_world.translation;
      b.put(image.id).put(q.w()).put(q.x()).put(q.y()).put(q.z()).put(t.x()).put(t.y()).put(t.z());
      b.put<uint32_t>(1).name("image").put<uint64_t>(static_cast<uint64_t>(image.keypoints));
      for (int k = 0; k < image.keypoints; ++k) b.put(1.5).put(2.5).put(~uint64_t{0});
    }
    return b.text;
  }
  std::string points_bin() const {
    Bytes b;
    b.put<uint64_t>(points.size());
    for (const TestPoint& point : points) {
      b.put(point.id).put(point.position.x()).put(point.position.y()).put(point.position.z());
      b.put<uint8_t>(1).put<uint8_t>(2).put<uint8_t>(3).put(0.5).put<uint64_t>(point.track.size());
      for (const auto& [image, keypoint] : point.track) b.put(image).put(keypoint);
    }
    return b.text;
  }
};

}  // namespace rumi::testing
