// SPDX-License-Identifier: BSD-3-Clause
// Camera models. Axes: x right, y down, z forward. Pixel (0, 0) is the centre of the upper-left pixel, as in OpenCV. In
// COLMAP that centre is (0.5, 0.5).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace rumi {

class Camera {
 public:
  enum class Model {
    kPinhole,        // radial-tangential distortion k1 k2 p1 p2 k3 (OpenCV's plumb bob)
    kKannalaBrandt,  // equidistant fisheye k1 k2 k3 k4 (OpenCV's fisheye)
  };

  Model model = Model::kPinhole;
  int width = 0;                                          // pixels
  int height = 0;                                         // pixels
  double fx = 0, fy = 0, cx = 0, cy = 0;                  // pixels
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0, k4 = 0;  // k4: fisheye only; p1 p2: pinhole only
  double fps = 0;                                         // nominal images per second; 0: unknown

  // Returns the pixel of a point in the camera's frame, or nullopt if it is behind the camera (z <= 0).
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& point_cam) const;
  // Returns the ray (x/z, y/z, 1) of a pixel, with distortion removed by iteration (error < 1e-9 for ordinary lenses).
  // If the iteration diverges at this pixel, the distortion is left in. A fisheye's ray at more than 89 degrees from
  // the axis is pulled in to that angle.
  Eigen::Vector3d unproject(const Eigen::Vector2d& pixel) const;
  // Returns the pixel without distortion: (fx x/z + cx, fy y/z + cy).
  Eigen::Vector2d undistort(const Eigen::Vector2d& pixel) const;
  // Returns the undistorted pixel of a point: the projection of an ideal pinhole camera. Precondition: z > 0.
  Eigen::Vector2d project_undistorted(const Eigen::Vector3d& point_cam) const {
    return {fx * point_cam.x() / point_cam.z() + cx, fy * point_cam.y() / point_cam.z() + cy};
  }
  // Returns the ray (x/z, y/z, 1) of an undistorted pixel in floats or doubles: the inverse of project_undistorted().
  template <class T>
  Eigen::Vector3d ray(const Eigen::Matrix<T, 2, 1>& undistorted) const {
    return {(undistorted.x() - cx) / fx, (undistorted.y() - cy) / fy, 1};
  }
  bool has_distortion() const;
  bool contains(const Eigen::Vector2d& pixel, double border_px = 0) const {
    return pixel.x() >= border_px && pixel.y() >= border_px && pixel.x() <= width - 1 - border_px &&
           pixel.y() <= height - 1 - border_px;
  }
  // Returns this camera for resized images. The pixels' centres are mapped, as by cv::resize.
  Camera resized(int new_width, int new_height) const;
  // Returns what is wrong with the calibration, with the field and its value; empty if it is fine.
  [[nodiscard]] std::string check() const;
};

}  // namespace rumi
