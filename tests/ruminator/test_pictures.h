// SPDX-License-Identifier: BSD-3-Clause
// Makes pictures of known geometry.
#pragma once

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "slam/geometry/camera.h"
#include "slam/geometry/transform.h"

namespace rumi::testing {
using namespace rumi::ruminator;

inline Camera picture_camera() {
  Camera c;
  c.width = 320, c.height = 240;
  c.fx = 262.5, c.fy = 260, c.cx = 159.5, c.cy = 119.5;
  return c;
}

// Draws a grey picture of 1500 filled circles with radii of 2 to 12 pixels at random places.
inline cv::Mat textured_picture(uint64_t seed, cv::Size size = {640, 480}) {
  cv::RNG random(seed);
  cv::Mat picture(size, CV_8U, cv::Scalar(128));
  for (int i = 0; i < 1500; ++i) {
    const cv::Point center(random.uniform(0, size.width), random.uniform(0, size.height));
    cv::circle(picture, center, 2 + static_cast<int>(10 * std::pow(random.uniform(0.0, 1.0), 2)),
               cv::Scalar(random.uniform(0, 256)), cv::FILLED, cv::LINE_AA);
  }
  cv::GaussianBlur(picture, picture, {}, 0.8);
  return picture;
}

// Renders the camera's view of a plane at z = 2, which shows the picture at a size of 4.8 x 3.6 units.
inline cv::Mat see_plane(const cv::Mat& picture, const Camera& camera, const SE3& cam_from_world) {
  const double unit = picture.cols / 4.8;  // pixels of the picture per unit
  const Eigen::Matrix3d r = cam_from_world.rotation.toRotationMatrix();
  Eigen::Matrix3d camera_from_picture;
  camera_from_picture.col(0) = r.col(0) / unit;
  camera_from_picture.col(1) = r.col(1) / unit;
  camera_from_picture.col(2) =
      cam_from_world * Eigen::Vector3d(-0.5 * picture.cols / unit, -0.5 * picture.rows / unit, 2);
  Eigen::Matrix3d k;
  k << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1;
  const Eigen::Matrix3d h = k * camera_from_picture;
  cv::Matx33d warp;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) warp(i, j) = h(i, j);
  cv::Mat seen;
  cv::warpPerspective(picture, seen, warp, {camera.width, camera.height}, cv::INTER_LINEAR, cv::BORDER_REFLECT);
  return seen;
}

// Maps `pixel` of the first camera to the second camera, through the point of the plane that it shows.
inline Eigen::Vector2d over_the_plane(const Camera& camera, const SE3& first, const SE3& second,
                                      const Eigen::Vector2d& pixel) {
  const SE3 world_from_first = first.inverse();
  const Eigen::Vector3d direction = world_from_first.rotation * camera.ray(pixel),
                        origin = world_from_first.translation;
  return camera.project_undistorted(second * (origin + (2 - origin.z()) / direction.z() * direction));
}

}  // namespace rumi::testing
