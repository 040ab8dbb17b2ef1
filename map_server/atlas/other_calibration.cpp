// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/atlas/other_calibration.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace rumi::map_server {
namespace {

constexpr double kMuch = 0.02;  // larger differences are reported; a share of the focal length or image width

struct Quantity {
  const char* name;
  double there, here;
  double unit;  // what a difference is divided by, px
};

// Returns the undistorted position, in pixels, of the middle of the image's left edge. The corners are not used,
// because there a distortion model may fold.
Eigen::Vector2d edge(const Camera& camera) {
  const Eigen::Vector3d ray = camera.unproject({0, camera.cy});
  return {camera.fx * ray.x(), camera.fy * ray.y()};
}

}  // namespace

std::string difference(const Camera& there, const Camera& here) {
  if (there.model != here.model) return "another model of the lens";
  // The two calibrations may be for different image sizes, because images may have been shrunk.
  const Camera same = there.resized(here.width, here.height);
  if (std::abs(same.width * there.height - same.height * there.width) > there.width + there.height)
    return fmt::format("{} x {} pixels there, {} x {} here", there.width, there.height, here.width, here.height);
  const double width = here.width;
  const std::array<Quantity, 4> quantities = {Quantity{"fx", same.fx, here.fx, same.fx},
                                              {"fy", same.fy, here.fy, same.fy},
                                              {"cx", same.cx, here.cx, width},
                                              {"cy", same.cy, here.cy, width}};
  for (const Quantity& q : quantities)
    if (std::abs(q.here - q.there) > kMuch * q.unit)
      return fmt::format("{} {:.0f} there, {:.0f} here", q.name, q.there, q.here);
  if ((edge(same) - edge(here)).norm() > kMuch * width)
    return fmt::format("another distortion: k1 {:.3g} there, {:.3g} here", same.k1, here.k1);
  return {};
}

std::string other_calibration(const Atlas& atlas, const Submap& submap) {
  for (const auto& [key, owner] : atlas.submaps()) {
    const bool is_before = key.session != submap.key.session && !atlas.present().contains(key.session);
    if (is_before && owner.submap.stream == submap.stream) return difference(owner.submap.camera, submap.camera);
  }
  return {};
}

}  // namespace rumi::map_server
