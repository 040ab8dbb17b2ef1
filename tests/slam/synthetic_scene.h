// SPDX-License-Identifier: BSD-3-Clause
// Points and cameras with known truth, seen with noise and outliers, for tests of the estimators.
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "slam/geometry/camera.h"
#include "slam/geometry/transform.h"

namespace rumi {

inline Camera test_camera() {
  Camera c;
  c.width = 640;
  c.height = 480;
  c.fx = 525;
  c.fy = 520;
  c.cx = 319.5;
  c.cy = 239.5;
  return c;
}

inline Camera test_fisheye() {
  Camera c = test_camera();
  c.model = Camera::Model::kKannalaBrandt;
  c.fx = c.fy = 280;
  c.k1 = -0.013;
  c.k2 = 0.02;
  c.k3 = -0.012;
  c.k4 = 0.002;
  return c;
}

class SyntheticScene {
 public:
  explicit SyntheticScene(unsigned seed) : rng_(seed) {}

  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(rng_); }
  Eigen::Vector2d noise(double sigma_px) {
    std::normal_distribution<double> n(0, 1);
    const double x = n(rng_), y = n(rng_);
    return sigma_px * Eigen::Vector2d(x, y);
  }
  // Returns points 2 to 8 units in front of a camera at the origin, far enough inside its view that it may move a
  // little.
  std::vector<Eigen::Vector3d> cloud(int count) {
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < count; ++i) {
      const double z = uniform(2, 8);
      const double y = z * uniform(-0.35, 0.35);  // before x: compilers evaluate arguments in different orders
      points.emplace_back(z * uniform(-0.45, 0.45), y, z);
    }
    return points;
  }
  // Returns points on a slanted plane.
  std::vector<Eigen::Vector3d> plane(int count) {
    std::vector<Eigen::Vector3d> points = cloud(count);
    for (Eigen::Vector3d& p : points) p *= 4.0 / (p.z() + 0.4 * p.x() + 0.2 * p.y());
    return points;
  }
  static SE3 pose(double x, double y, double z, double yaw_rad = 0, double pitch_rad = 0) {
    const SE3 world_from_cam(so3_exp({pitch_rad, yaw_rad, 0}), Eigen::Vector3d(x, y, z));
    return world_from_cam.inverse();
  }
  std::mt19937& rng() { return rng_; }

 private:
  std::mt19937 rng_;
};

// The whitening and the error of a keypoint on an edge. The error's standard deviation is sigma_px across the edge, and
// `ratio` times as much along it (direction `along_rad`).
struct EdgeNoise {
  Eigen::Matrix2d whitening;
  Eigen::Vector2d error;
};
inline EdgeNoise edge_noise(SyntheticScene& scene, double sigma_px, double along_rad, double ratio) {
  const Eigen::Vector2d along(std::cos(along_rad), std::sin(along_rad)), across(-along.y(), along.x());
  const Eigen::Vector2d noise = scene.noise(sigma_px);
  return {across * across.transpose() + along * along.transpose() / ratio,
          across * noise.x() + along * noise.y() * ratio};
}

inline double rotation_error_deg(const SE3& a, const SE3& b) { return (a * b.inverse()).angle_rad() * 180 / M_PI; }

}  // namespace rumi
