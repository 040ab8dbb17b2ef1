// SPDX-License-Identifier: BSD-3-Clause
// Keypoints and matches as seen by a camera that turns, and may move, in front of random points.
#pragma once

#include <Eigen/Geometry>
#include <opencv2/core.hpp>
#include <vector>

#include "ruminator/matching/sift_features.h"
#include "ruminator/matching/window_image.h"

namespace rumi::ruminator::testing {

// All images see all points, and all pairs of images are matched. From image to image the camera turns by 2 degrees and
// moves by `step`.
struct Film {
  Camera camera;
  std::vector<SiftFeatures> images;
  std::vector<ImagePair> pairs;
};

inline Film film(int images, double step) {
  Film film;
  film.camera.width = 640, film.camera.height = 480;
  film.camera.fx = film.camera.fy = 500, film.camera.cx = 320, film.camera.cy = 240;
  cv::RNG random(9);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 200; ++i)
    points.emplace_back(random.uniform(-2.0, 2.0), random.uniform(-1.5, 1.5), random.uniform(3.0, 7.0));
  for (int k = 0; k < images; ++k) {
    const Eigen::AngleAxisd turn(k * 2 * M_PI / 180, Eigen::Vector3d::UnitY());
    SiftFeatures& seen = film.images.emplace_back();
    for (const Eigen::Vector3d& point : points) {
      const Eigen::Vector3d p = turn * (point - Eigen::Vector3d(k * step, 0, 0));
      seen.undistorted.emplace_back(static_cast<float>(500 * p.x() / p.z() + 320 + random.gaussian(0.5)),
                                    static_cast<float>(500 * p.y() / p.z() + 240 + random.gaussian(0.5)));
    }
    for (int other = 0; other < k; ++other) {
      ImagePair& pair = film.pairs.emplace_back(ImagePair{other, k, {}});
      for (int i = 0; i < 200; ++i) pair.matches.emplace_back(i, i);
    }
  }
  return film;
}

}  // namespace rumi::ruminator::testing
