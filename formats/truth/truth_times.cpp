// SPDX-License-Identifier: BSD-3-Clause
#include "formats/truth/truth_times.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "formats/truth/text_fields.h"
#include "slam/numeric/steps.h"

namespace rumi {
namespace {

namespace fs = std::filesystem;

constexpr double kLatestNumber = 1e8;  // three years in seconds; larger numbers are no numbers of images

double usual_step_of(const std::vector<RawPose>& poses) {
  std::vector<double> times;
  times.reserve(poses.size());
  for (const RawPose& pose : poses) times.push_back(pose.time.value);
  std::sort(times.begin(), times.end());
  return usual_step(times);
}

}  // namespace

std::optional<int64_t> to_us(const RawTime& time, double per_second) {
  if (!(std::abs(time.value / per_second * 1e6) < 0x1p53)) return std::nullopt;
  if (time.whole && per_second == 1e9) return *time.whole / 1000;
  if (time.whole && per_second == 1e6) return *time.whole;
  return std::llround(time.value / per_second * 1e6);
}

bool are_small_and_whole(const std::vector<RawPose>& poses) {
  return std::all_of(poses.begin(), poses.end(),
                     [](const RawPose& pose) { return pose.time.whole && std::abs(pose.time.value) < kLatestNumber; });
}

bool are_numbers_of_images(const std::vector<RawPose>& poses, const TruthOptions& options) {
  if (!options.run || poses.size() < 3 || !are_small_and_whole(poses) || usual_step_of(poses) != 1) return false;
  return options.run->period_us < 500'000 || options.run->period_us > 2'000'000;
}

TimeUnit unit_of(const std::vector<RawPose>& poses, const TruthOptions& options) {
  // Least value that a time since 1970 has in each of kTimeUnits.
  constexpr std::array kLeast = {0.0, 1e11, 1e14, 1e17};
  const auto [first, last] = std::minmax_element(
      poses.begin(), poses.end(), [](const RawPose& a, const RawPose& b) { return a.time.value < b.time.value; });
  const double begin = first->time.value, end = last->time.value, step = usual_step_of(poses);
  TimeUnit by_size = kTimeUnits[0];
  for (size_t i = 0; i < kTimeUnits.size(); ++i)
    if (begin >= kLeast.at(i)) by_size = kTimeUnits.at(i);
  if (!options.run) return by_size;
  const auto overlaps = [&](TimeUnit unit) {
    const double us = 1e6 / per_second(unit);
    return begin * us <= static_cast<double>(options.run->last_us) &&
           end * us >= static_cast<double>(options.run->first_us);
  };
  const auto is_usual = [&](TimeUnit unit) { return step / per_second(unit) > 2e-4 && step / per_second(unit) < 20; };
  if (overlaps(by_size) && is_usual(by_size)) return by_size;
  for (const TimeUnit unit : kTimeUnits)
    if (overlaps(unit) && is_usual(unit)) return unit;
  return by_size;
}

std::optional<std::vector<double>> read_times(const std::string& truth_file, std::string* file) {
  const fs::path truth = truth_file;
  const fs::path folder = truth.parent_path();
  const fs::path above = folder / "..";
  for (const fs::path& candidate :
       {folder / "times.txt", above / "times.txt", above / "sequences" / truth.stem() / "times.txt"}) {
    const std::optional<TruthTable> table = read_truth_table(candidate.string());
    if (!table || table->lines.empty()) continue;
    std::vector<double> times;
    for (const TruthLine& line : table->lines)
      if (const auto time = line.fields.empty() ? std::nullopt : to_number(line.fields[0])) times.push_back(*time);
    *file = candidate.lexically_normal().string();
    return times;
  }
  return std::nullopt;
}

}  // namespace rumi
