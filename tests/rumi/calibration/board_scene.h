// SPDX-License-Identifier: BSD-3-Clause
// Renders images of a calibration board as a known camera would take them.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <random>
#include <vector>

#include "rumi/calibration/board.h"
#include "slam/geometry/camera.h"
#include "slam/geometry/transform.h"

namespace rumi::testing {
using namespace rumi::tool;

struct BoardPose {  // cam_from_board, mm
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;
};

// The difference between a photograph and an ideal image.
struct Optics {
  double blur_px = 0.7;  // standard deviation
  double noise = 2;      // grey levels, standard deviation
};

class BoardScene {
 public:
  BoardScene(const Board& board, const Camera& camera) : board_(board), camera_(camera) {
    draw_texture();
    for (int y = 0; y < kFiner * camera.height; ++y)
      for (int x = 0; x < kFiner * camera.width; ++x)
        rays_.push_back(camera.unproject({(x + 0.5) / kFiner - 0.5, (y + 0.5) / kFiner - 0.5}));
  }

  cv::Mat render(const BoardPose& pose, const Optics& optics, int seed) const {
    Eigen::Matrix3d image_from_plane;
    image_from_plane << pose.rotation.col(0), pose.rotation.col(1), pose.translation;
    const Eigen::Matrix3d plane_from_ray = image_from_plane.inverse();
    cv::Mat_<cv::Vec2f> map(kFiner * camera_.height, kFiner * camera_.width);
    for (size_t i = 0; i < rays_.size(); ++i) {
      const Eigen::Vector3d p = plane_from_ray * rays_[i];
      const bool ahead = p.z() > 0;
      map(static_cast<int>(i)) =
          ahead ? cv::Vec2f(texture_px(p.x() / p.z()), texture_px(p.y() / p.z())) : cv::Vec2f(-1e4f, -1e4f);
    }
    cv::Mat fine, image;
    constexpr int kWall = 120;
    cv::remap(texture_, fine, map, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_CONSTANT, cv::Scalar(kWall));
    cv::resize(fine, image, {camera_.width, camera_.height}, 0, 0, cv::INTER_AREA);
    if (optics.blur_px > 0) cv::GaussianBlur(image, image, {}, optics.blur_px);
    cv::Mat noise(image.size(), CV_16S), out;
    cv::RNG(seed).fill(noise, cv::RNG::NORMAL, 0, optics.noise);
    cv::add(image, noise, out, cv::noArray(), CV_8U);
    return out;
  }

  // Returns a pose in which the board's middle is at `pixel`. `degrees`: the angle that its diagonal spans when seen
  // from the front. It is then tilted and rolled.
  BoardPose pose(const Eigen::Vector2d& pixel, double degrees, double tilt_x_rad, double tilt_y_rad,
                 double roll_rad) const {
    const double distance = std::hypot(board_.width_mm(), board_.height_mm()) / 2 / std::tan(degrees * M_PI / 360);
    const Eigen::Vector3d sight = camera_.unproject(pixel).normalized();
    BoardPose pose;
    // The board faces the camera and is turned from there, as if somebody held it who walks around.
    pose.rotation = shortest_turn(Eigen::Vector3d::UnitZ(), sight).toRotationMatrix() *
                    (Eigen::AngleAxisd(tilt_x_rad, Eigen::Vector3d::UnitY()) *
                     Eigen::AngleAxisd(tilt_y_rad, Eigen::Vector3d::UnitX()) *
                     Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitZ()))
                        .toRotationMatrix();
    pose.translation =
        sight * distance - pose.rotation * Eigen::Vector3d(board_.width_mm() / 2, board_.height_mm() / 2, 0);
    return pose;
  }

  // Returns poses of a board that somebody holds at many places of the image, near and far, turned to all sides.
  // `nearest_degrees`: the angle that the diagonal spans (see pose()) where the board is nearest. `margin`: least
  // distance of the board's middle from the image's edges, as a share of the image's width and height.
  std::vector<BoardPose> varied_poses(int count, double nearest_degrees, double margin = 0.15) const {
    std::mt19937 random(7);
    const auto between = [&random](double low, double high) {
      return low + (high - low) * static_cast<double>(random() - random.min()) /
                       static_cast<double>(random.max() - random.min());
    };
    std::vector<BoardPose> poses;
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector2d pixel(camera_.width * between(margin, 1 - margin),
                                  camera_.height * between(margin, 1 - margin));
      poses.push_back(pose(pixel, nearest_degrees * between(0.5, 1), between(-0.75, 0.75), between(-0.75, 0.75),
                           between(-0.3, 0.3)));
    }
    return poses;
  }

 private:
  static constexpr int kFiner = 2;     // rendered samples per pixel, in each direction
  static constexpr int kRimMm = 30;    // white paper around the board
  static constexpr double kPerMm = 4;  // texture pixels; the sides of squares must be whole numbers of them

  static float texture_px(double mm) { return static_cast<float>((mm + kRimMm) * kPerMm - 0.5); }

  void draw_texture() {
    constexpr int kBlack = 25, kWhite = 230;
    texture_.create(static_cast<int>((board_.height_mm() + 2 * kRimMm) * kPerMm),
                    static_cast<int>((board_.width_mm() + 2 * kRimMm) * kPerMm), CV_8U);
    texture_ = kWhite;
    const auto edge = [](double mm) { return static_cast<int>(std::lround((mm + kRimMm) * kPerMm)); };
    for (const cv::Rect2d& r : board_.black_mm())
      texture_(cv::Rect(cv::Point(edge(r.x), edge(r.y)), cv::Point(edge(r.x + r.width), edge(r.y + r.height)))) =
          kBlack;
  }

  Board board_;
  Camera camera_;
  cv::Mat texture_;
  std::vector<Eigen::Vector3d> rays_;
};

inline Camera pinhole_camera(int width, int height) {
  Camera camera;
  camera.width = width, camera.height = height;
  camera.fx = 0.82 * width, camera.fy = 0.815 * width;
  camera.cx = 0.51 * width, camera.cy = 0.485 * height;
  camera.k1 = -0.28, camera.k2 = 0.07, camera.p1 = 2e-4, camera.p2 = -3e-4;
  return camera;
}

inline Camera fisheye_camera(int width, int height) {
  Camera camera;
  camera.model = Camera::Model::kKannalaBrandt;
  camera.width = width, camera.height = height;
  camera.fx = 0.44 * width, camera.fy = 0.438 * width;
  camera.cx = 0.495 * width, camera.cy = 0.51 * height;
  camera.k1 = -0.02, camera.k2 = 0.006, camera.k3 = -0.003, camera.k4 = 0.0005;
  return camera;
}

}  // namespace rumi::testing
