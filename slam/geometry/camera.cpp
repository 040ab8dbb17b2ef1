// SPDX-License-Identifier: BSD-3-Clause
#include "slam/geometry/camera.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "slam/geometry/max_side.h"
#include "slam/geometry/radial_distortion.h"

namespace rumi {
namespace {

Eigen::Vector2d distort_pinhole(const Camera& c, double x, double y) {
  const double r2 = x * x + y * y;
  const double radial = 1 + r2 * (c.k1 + r2 * (c.k2 + r2 * c.k3));
  return {x * radial + 2 * c.p1 * x * y + c.p2 * (r2 + 2 * x * x),
          y * radial + c.p1 * (r2 + 2 * y * y) + 2 * c.p2 * x * y};
}

RadialDistortion of_angle(const Camera& c) { return {c.k1, c.k2, c.k3, c.k4}; }

// A ray at 90 degrees or more cannot be written as (x/z, y/z, 1). It is pulled in to this angle.
constexpr double kWidestAngle_rad = 89.0 * M_PI / 180.0;
constexpr double kSteepestSlope = 1e4;  // x/z or y/z: no lens with an invertible distortion sees farther aside

// Returns the angle that the lens distorts into `distorted` (radians), by Newton's method. If the distortion cannot be
// inverted there, the result is arbitrary, and may be NaN or infinite.
double undistort_angle(const Camera& c, double distorted) {
  const RadialDistortion lens = of_angle(c);
  double theta = distorted;
  for (int i = 0; i < 20; ++i) {
    const double step = (lens.distorted(theta) - distorted) / lens.slope(theta);
    theta -= step;
    if (std::abs(step) < 1e-12) break;
  }
  return theta;
}

Eigen::Vector3d unproject_pinhole(const Camera& c, double xd, double yd) {
  double x = xd, y = yd;
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector2d d = distort_pinhole(c, x, y);
    const double ex = xd - d.x(), ey = yd - d.y();
    x += ex;
    y += ey;
    if (ex * ex + ey * ey < 1e-20) break;
  }
  const bool is_undone = std::abs(x) <= kSteepestSlope && std::abs(y) <= kSteepestSlope;
  return is_undone ? Eigen::Vector3d(x, y, 1) : Eigen::Vector3d(xd, yd, 1);
}

Eigen::Vector3d unproject_fisheye(const Camera& c, double xd, double yd) {
  const double r = std::hypot(xd, yd);
  if (r < 1e-12) return {xd, yd, 1};
  const double angle = undistort_angle(c, r);
  const double theta = std::clamp(std::isfinite(angle) ? angle : r, -kWidestAngle_rad, kWidestAngle_rad);
  const double k = std::tan(theta) / r;
  return {k * xd, k * yd, 1};
}

}  // namespace

std::optional<Eigen::Vector2d> Camera::project(const Eigen::Vector3d& p) const {
  if (!(p.z() > 0)) return std::nullopt;
  const double x = p.x() / p.z(), y = p.y() / p.z();
  Eigen::Vector2d d(x, y);
  if (model == Model::kPinhole) {
    if (has_distortion()) d = distort_pinhole(*this, x, y);
  } else {
    const double r = std::hypot(x, y);
    if (r > 1e-12) d *= of_angle(*this).distorted(std::atan(r)) / r;
  }
  return Eigen::Vector2d(fx * d.x() + cx, fy * d.y() + cy);
}

Eigen::Vector3d Camera::unproject(const Eigen::Vector2d& pixel) const {
  const double x = (pixel.x() - cx) / fx, y = (pixel.y() - cy) / fy;
  if (model == Model::kKannalaBrandt) return unproject_fisheye(*this, x, y);
  return has_distortion() ? unproject_pinhole(*this, x, y) : Eigen::Vector3d(x, y, 1);
}

Eigen::Vector2d Camera::undistort(const Eigen::Vector2d& pixel) const {
  return has_distortion() ? project_undistorted(unproject(pixel)) : pixel;
}

bool Camera::has_distortion() const {
  return model == Model::kKannalaBrandt || k1 != 0 || k2 != 0 || p1 != 0 || p2 != 0 || k3 != 0;
}

Camera Camera::resized(int new_width, int new_height) const {
  const double across = static_cast<double>(new_width) / width, down = static_cast<double>(new_height) / height;
  Camera c = *this;
  c.width = new_width;
  c.height = new_height;
  c.fx = fx * across;
  c.fy = fy * down;
  c.cx = (cx + 0.5) * across - 0.5;
  c.cy = (cy + 0.5) * down - 0.5;
  return c;
}

std::string Camera::check() const {
  std::ostringstream out;
  const auto fail = [&out](const char* field, double value, const char* why) {
    out << field << " is " << value << ": " << why;
    return out.str();
  };
  const std::pair<const char*, double> numbers[] = {{"fx", fx}, {"fy", fy}, {"cx", cx}, {"cy", cy}, {"k1", k1},
                                                    {"k2", k2}, {"p1", p1}, {"p2", p2}, {"k3", k3}, {"k4", k4}};
  for (const auto& [name, value] : numbers)
    if (!std::isfinite(value)) return fail(name, value, "must be a finite number");
  if (width < 16 || width > kMaxSide) return fail("width", width, "must be 16 to 16384 pixels");
  if (height < 16 || height > kMaxSide) return fail("height", height, "must be 16 to 16384 pixels");
  const auto is_focal_length = [this](double f) { return f >= 0.05 * width && f <= 100.0 * width; };
  if (!is_focal_length(fx)) return fail("fx", fx, "must be in pixels, and of the order of the image width");
  if (!is_focal_length(fy)) return fail("fy", fy, "must be in pixels, and of the order of the image width");
  if (fy < fx / 3 || fy > 3 * fx) return fail("fy", fy, "must be of the order of fx: pixels are about square");
  if (cx < 0 || cx > width) return fail("cx", cx, "must lie in the image");
  if (cy < 0 || cy > height) return fail("cy", cy, "must lie in the image");
  if (cx <= 1 && cy <= 1) return fail("cx", cx, "must be in pixels, as cy: these are parts of the width and height");
  return {};
}

}  // namespace rumi
