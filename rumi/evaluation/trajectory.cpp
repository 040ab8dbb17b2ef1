// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/evaluation/trajectory.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>

namespace rumi::tool {
namespace {

std::vector<std::string> split(const std::string& line, const char* separators) {
  std::vector<std::string> fields;
  size_t begin = line.find_first_not_of(separators);
  while (begin != std::string::npos) {
    const size_t end = line.find_first_of(separators, begin);
    fields.push_back(line.substr(begin, end == std::string::npos ? end : end - begin));
    begin = end == std::string::npos ? end : line.find_first_not_of(separators, end);
  }
  return fields;
}

// Empty fields count; the end of the line may be that of another system.
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
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), *value);
  return error == std::errc() && end == text.data() + text.size();
}

// Of the fields at `columns` (none: the file has no such columns). False if one of them is no number.
bool parse_sigmas(const std::vector<std::string>& fields, const std::vector<size_t>& columns, PoseSigmas* sigmas) {
  std::vector<double> values;
  for (const size_t column : columns) {
    if (fields[column].empty()) return true;
    if (!parse(fields[column], &values.emplace_back())) return false;
  }
  if (!values.empty()) *sigmas = pose_sigmas(values[0], values[1], values[2]);
  return true;
}

std::optional<double> to_number(const std::string& text) {
  double value = 0;
  return parse(text, &value) && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

// The numbers of a line, or nothing if one of the first `count` is missing or not finite.
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

std::optional<SE3> make_pose(double x, double y, double z, double qw, double qx, double qy, double qz) {
  const Eigen::Quaterniond q(qw, qx, qy, qz);
  if (std::abs(q.norm() - 1.0) > 0.01) return std::nullopt;
  return SE3(q, {x, y, z});
}

// Far enough from the ends of the numbers for the difference of two times.
bool is_time(int64_t utime_us) { return std::abs(static_cast<double>(utime_us)) < 0x1p53; }

// Six decimals of a second fit a double until the year 2255, so rounding recovers the microsecond that was written.
int64_t to_us(double seconds) { return std::llround(seconds * 1e6); }

void sort_by_time(TrajectoryFile* result) {
  auto& poses = result->poses;
  std::stable_sort(poses.begin(), poses.end(), [](auto& a, auto& b) { return a.utime_us < b.utime_us; });
  const auto end = std::unique(poses.begin(), poses.end(), [](auto& a, auto& b) { return a.utime_us == b.utime_us; });
  result->skipped_lines += static_cast<int>(poses.end() - end);
  poses.erase(end, poses.end());
}

// Reads the lines with a function that makes a pose of one, or nothing.
template <class ParseLine>
TrajectoryFile read_lines(const std::string& file, const std::string& expected, ParseLine parse) {
  TrajectoryFile result;
  std::ifstream in(file);
  if (!in || std::filesystem::is_directory(file)) {
    result.error = fmt::format("{}: cannot be read: does the file exist?", file);
    return result;
  }
  for (std::string line; std::getline(in, line);) {
    if (line.find_first_not_of(" \t\r") == std::string::npos || line[line.find_first_not_of(" \t")] == '#') continue;
    const std::optional<TimedPose> pose = parse(line);
    if (pose && is_time(pose->utime_us)) {
      result.poses.push_back(*pose);
    } else {
      ++result.skipped_lines;
    }
  }
  sort_by_time(&result);
  if (result.poses.empty() && result.skipped_lines > 0) {
    result.error = fmt::format("{}: none of {} lines is {}", file, result.skipped_lines, expected);
  }
  return result;
}

// T_BS of sensor.yaml: body_from_cam.
std::optional<SE3> read_body_from_cam(const std::filesystem::path& sensor_yaml) {
  try {
    const auto values = YAML::LoadFile(sensor_yaml.string())["T_BS"]["data"].as<std::vector<double>>();
    if (values.size() != 16) return std::nullopt;
    const Eigen::Matrix4d m = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(values.data());
    const SE3 pose(Eigen::Matrix3d(m.topLeftCorner<3, 3>()), m.topRightCorner<3, 1>());
    return pose.is_finite() ? std::optional(pose) : std::nullopt;
  } catch (const YAML::Exception&) {
    return std::nullopt;
  }
}

TrajectoryFile read_euroc(const std::string& file) {
  const auto sensor = std::filesystem::path(file).parent_path().parent_path() / "cam0" / "sensor.yaml";
  const std::optional<SE3> body_from_cam = read_body_from_cam(sensor);
  if (!body_from_cam) {
    TrajectoryFile failure;
    failure.error = fmt::format(
        "{}: EuRoC's truth is of the body, and {} with T_BS (16 numbers), which says where the camera is on it, cannot "
        "be "
        "read: keep the truth in its place in the dataset's folder",
        file, sensor.string());
    return failure;
  }
  return read_lines(
      file, "a line of EuRoC ground truth (ns, x, y, z, qw, qx, qy, qz, ...)",
      [&](const std::string& line) -> std::optional<TimedPose> {
        const auto fields = split(line, ", \t\r");
        const auto v = numbers(fields, 8);
        int64_t ns = 0;
        if (!v || std::from_chars(fields[0].data(), fields[0].data() + fields[0].size(), ns).ec != std::errc()) {
          return std::nullopt;
        }
        const auto body = make_pose((*v)[1], (*v)[2], (*v)[3], (*v)[4], (*v)[5], (*v)[6], (*v)[7]);
        if (!body) return std::nullopt;
        return TimedPose{ns / 1000, *body * *body_from_cam};
      });
}

bool looks_like_euroc(const std::string& file) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (!line.empty() && line[0] != '#') return line.find(',') != std::string::npos;
  }
  return false;
}

}  // namespace

TrajectoryFile read_trajectory(const std::string& file, const TruthOptions& options) {
  const double to_seconds = options.frames_per_second > 0 ? 1.0 / options.frames_per_second : 1.0;
  return read_lines(file, "a pose in TUM format (time tx ty tz qx qy qz qw)",
                    [&](const std::string& line) -> std::optional<TimedPose> {
                      const auto v = numbers(split(line, " \t\r"), 8);
                      if (!v) return std::nullopt;
                      const auto pose = make_pose((*v)[1], (*v)[2], (*v)[3], (*v)[7], (*v)[4], (*v)[5], (*v)[6]);
                      if (!pose) return std::nullopt;
                      return TimedPose{to_us((*v)[0] * to_seconds), *pose};
                    });
}

TrajectoryFile read_groundtruth(const std::string& file, const TruthOptions& options) {
  TrajectoryFile result = looks_like_euroc(file) ? read_euroc(file) : read_trajectory(file, options);
  if (result.ok() && result.poses.empty()) result.error = fmt::format("{}: holds no poses", file);
  return result;
}

FramesFile read_frames(const std::string& file) {
  FramesFile result;
  std::ifstream in(file);
  std::string line;
  if (!in || !std::getline(in, line)) {
    result.error = fmt::format("{}: cannot be read, or is empty: is this the output folder of a run?", file);
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

}  // namespace rumi::tool
