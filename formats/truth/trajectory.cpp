// SPDX-License-Identifier: BSD-3-Clause
#include "formats/truth/trajectory.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>

#include "base/files/file_access.h"
#include "base/text/number_text.h"
#include "base/text/time_units.h"
#include "formats/truth/text_fields.h"

namespace rumi {
namespace {

// Splits a line, with empty fields; accepts line ends of other systems.
std::vector<std::string> split_csv(const std::string& line) {
  std::vector<std::string> fields;
  const size_t length = line.ends_with('\r') ? line.size() - 1 : line.size();
  for (size_t begin = 0; begin <= length;) {
    const size_t end = std::min(line.find(',', begin), length);
    fields.push_back(line.substr(begin, end - begin));
    begin = end + 1;
  }
  return fields;
}

template <class Number>
bool parse(const std::string& text, Number* value) {
  const auto number = parse_number<Number>(text);
  if (number) *value = *number;
  return number.has_value();
}

// Reads the sigmas from the fields at `columns`; leaves them as they are if `columns` is empty (the file has no such
// columns) or a field is empty. Returns false if a field is not a number.
bool parse_sigmas(const std::vector<std::string>& fields, const std::vector<size_t>& columns, PoseSigmas* sigmas) {
  std::vector<double> values;
  for (const size_t column : columns) {
    if (fields[column].empty()) return true;
    if (!parse(fields[column], &values.emplace_back())) return false;
  }
  if (!values.empty()) *sigmas = pose_sigmas(values[0], values[1], values[2]);
  return true;
}

// Returns the first `count` numbers of a line; nullopt if one is missing or not finite.
std::optional<std::vector<double>> numbers(const std::vector<std::string>& fields, size_t count) {
  if (fields.size() < count) return std::nullopt;
  std::vector<double> values(count);
  for (size_t i = 0; i < count; ++i) {
    const std::optional<double> value = to_number(fields[i]);
    if (!value) return std::nullopt;
    values[i] = *value;
  }
  return values;
}

// True if the difference of two such times cannot overflow.
bool is_time(int64_t utime_us) { return std::abs(static_cast<double>(utime_us)) < 0x1p53; }

void sort_by_time(TrajectoryFile* result) {
  auto& poses = result->poses;
  std::stable_sort(poses.begin(), poses.end(), [](auto& a, auto& b) { return a.utime_us < b.utime_us; });
  const auto end = std::unique(poses.begin(), poses.end(), [](auto& a, auto& b) { return a.utime_us == b.utime_us; });
  result->skipped_lines += static_cast<int>(poses.end() - end);
  poses.erase(end, poses.end());
}

std::optional<TimedPose> parse_pose(const std::string& line) {
  const auto v = numbers(split(line, " \t\r"), 8);
  if (!v) return std::nullopt;
  const Eigen::Quaterniond q((*v)[7], (*v)[4], (*v)[5], (*v)[6]);
  const int64_t utime_us = to_us((*v)[0]);
  const Eigen::Vector3d position((*v)[1], (*v)[2], (*v)[3]);
  if (std::abs(q.norm() - 1.0) > 0.01 || !is_time(utime_us)) return std::nullopt;
  if (position.cwiseAbs().maxCoeff() > kLargestPosition) return std::nullopt;
  return TimedPose{utime_us, SE3(q, position)};
}

}  // namespace

TrajectoryFile read_trajectory(const std::string& file) {
  TrajectoryFile result;
  std::ifstream in(file);
  std::string why = why_unreadable(file, "give the output folder of a run, or a file of poses");
  if (why.empty() && (!in || std::filesystem::is_directory(file))) why = "is no file";
  if (!why.empty()) {
    result.error = fmt::format("{}: {}", file, why);
    return result;
  }
  for (std::string line; std::getline(in, line);) {
    if (line.find_first_not_of(" \t\r") == std::string::npos || line[line.find_first_not_of(" \t")] == '#') continue;
    if (const std::optional<TimedPose> pose = parse_pose(line))
      result.poses.push_back(*pose);
    else
      ++result.skipped_lines;
  }
  sort_by_time(&result);
  if (result.poses.empty() && result.skipped_lines > 0)
    result.error = fmt::format("{}: none of {} lines is a pose in TUM format (time tx ty tz qx qy qz qw)", file,
                               result.skipped_lines);
  return result;
}

FramesFile read_frames(const std::string& file) {
  FramesFile result;
  std::ifstream in(file);
  std::string line;
  if (!in || !std::getline(in, line)) {
    const std::string why = why_unreadable(file, "is this the output folder of a run?");
    result.error = fmt::format("{}: {}", file, why.empty() ? "is empty" : why);
    return result;
  }
  const auto names = split_csv(line);
  const auto column = [&](const char* name) { return std::find(names.begin(), names.end(), name) - names.begin(); };
  const size_t utime = column("utime"), state = column("state"), submap = column("submap"), in_map = column("in_map");
  if (std::max({utime, state, submap, in_map}) >= names.size()) {
    result.error = fmt::format("{}: first line '{}' does not name the columns utime,state,submap,in_map", file, line);
    return result;
  }
  std::vector<size_t> sigmas;
  for (const char* name : {"position_sigma", "rotation_sigma_rad", "log_scale_sigma"}) sigmas.push_back(column(name));
  if (std::ranges::max(sigmas) >= names.size()) sigmas.clear();
  for (int number = 2; std::getline(in, line); ++number) {
    if (line.find_first_not_of("\r") == std::string::npos) continue;
    const auto fields = split_csv(line);
    InputFrame frame;
    int in_map_value = 0;
    if (fields.size() != names.size() || !parse(fields[utime], &frame.utime_us) || !is_time(frame.utime_us) ||
        !parse(fields[submap], &frame.submap) || !parse(fields[in_map], &in_map_value) ||
        !parse_sigmas(fields, sigmas, &frame.sigmas)) {
      result.error = fmt::format("{}, line {}: '{}' is not utime,state,submap,in_map", file, number, line);
      return result;
    }
    frame.state = fields[state];
    frame.in_map = in_map_value != 0;
    result.frames.push_back(frame);
  }
  std::stable_sort(result.frames.begin(), result.frames.end(),
                   [](auto& a, auto& b) { return a.utime_us < b.utime_us; });
  return result;
}

}  // namespace rumi
