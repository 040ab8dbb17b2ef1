// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/recording/missing_images.h"

#include <cmath>

#include "slam/numeric/median.h"

namespace rumi::camera_driver {

MissingImages find_missing_images(const std::vector<OrderedFrame>& frames) {
  constexpr double kMaxUneven = 0.2;  // share of a period by which a step of whole periods may be off
  constexpr double kMinWhole = 0.9;   // least share of steps that are whole periods; below it nothing is counted
  constexpr double kPause = 10.5;     // periods; a step that is longer is a pause
  std::vector<int64_t> steps_us;
  for (size_t i = 1; i < frames.size(); ++i)
    if (frames[i].part == frames[i - 1].part) steps_us.push_back(frames[i].utime_us - frames[i - 1].utime_us);
  if (steps_us.empty()) return {};
  std::vector<int64_t> copy = steps_us;
  MissingImages missing{0, median(&copy)};
  int64_t whole = 0;
  for (const int64_t step_us : steps_us) {
    const double periods = static_cast<double>(step_us) / static_cast<double>(missing.period_us);
    whole += std::abs(periods - std::round(periods)) <= kMaxUneven && periods > 0.5;
    if (periods > 1.5 && periods < kPause) missing.count += std::llround(periods) - 1;
  }
  if (static_cast<double>(whole) < kMinWhole * static_cast<double>(steps_us.size())) missing.count = 0;
  return missing;
}

}  // namespace rumi::camera_driver
