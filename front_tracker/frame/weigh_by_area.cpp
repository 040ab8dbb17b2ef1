// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/frame/weigh_by_area.h"

#include <algorithm>
#include <cmath>

namespace rumi::front_tracker {
namespace {

constexpr int kColumns = 12;

}  // namespace

void weigh_by_area(const Camera& camera, std::vector<PointObservation>* observations) {
  const double cell_px = static_cast<double>(camera.width) / kColumns;
  const int rows = static_cast<int>(std::ceil(camera.height / cell_px));
  // Undistorted pixels may lie outside the image or be NaN.
  const auto along = [&](double pixel, int cells) {
    return pixel > 0 ? static_cast<int>(std::min(pixel / cell_px, cells - 1.0)) : 0;
  };
  const auto cell_of = [&](const PointObservation& o) {
    return along(o.pixel.y(), rows) * kColumns + along(o.pixel.x(), kColumns);
  };
  std::vector<int> count(static_cast<size_t>(rows) * kColumns, 0);
  for (const PointObservation& o : *observations) ++count[cell_of(o)];
  const auto empty = std::count(count.begin(), count.end(), 0);
  const double share = static_cast<double>(observations->size()) / static_cast<double>(count.size() - empty);
  for (PointObservation& o : *observations) o.weight = share / count[cell_of(o)];
}

}  // namespace rumi::front_tracker
