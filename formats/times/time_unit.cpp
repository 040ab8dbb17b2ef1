// SPDX-License-Identifier: BSD-3-Clause
#include "formats/times/time_unit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "slam/numeric/steps.h"

namespace rumi {
namespace {

constexpr double kMinHz = 0.05, kMaxHz = 2000;  // from a picture every 20 s to a high-speed camera
constexpr double kUsualHz = 30;

// Returns the rate in images a second, by the median of the steps between different times; 0: not known.
double rate_hz(const std::vector<std::string>& texts, TimeUnit unit) {
  std::vector<int64_t> times;
  for (const std::string& text : texts)
    if (const std::optional<int64_t> utime_us = parse_time_us(text, unit)) times.push_back(*utime_us);
  if (2 * times.size() < texts.size()) return 0;
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  if (times.size() < 3) return 0;
  return 1e6 / static_cast<double>(usual_step(times));
}

bool is_of_a_camera(double hz) { return hz >= kMinHz && hz <= kMaxHz; }

}  // namespace

ChosenUnit choose_time_unit(const std::vector<std::string>& times, TimeUnit usual) {
  const double usual_hz = rate_hz(times, usual);
  if (is_of_a_camera(usual_hz)) return {usual, ""};
  double best_hz = 0, least = std::numeric_limits<double>::infinity();
  TimeUnit best = usual;
  for (const TimeUnit unit : kTimeUnits) {
    const double hz = rate_hz(times, unit);
    if (!is_of_a_camera(hz) || std::abs(std::log(hz / kUsualHz)) >= least) continue;
    least = std::abs(std::log(hz / kUsualHz));
    best = unit;
    best_hz = hz;
  }
  if (best == usual) return {usual, ""};
  const std::string otherwise = usual_hz > 0
                                    ? fmt::format(", not as {}, which would give {:.3g}", name_of(usual), usual_hz)
                                    : fmt::format(", because they are too large for {}", name_of(usual));
  return {best, fmt::format("times are read as {}, {:.3g} images a second{}", name_of(best), best_hz, otherwise)};
}

}  // namespace rumi
