// SPDX-License-Identifier: BSD-3-Clause
#include "formats/truth/body_frame.h"

#include <yaml-cpp/yaml.h>

#include <vector>

namespace rumi {
namespace {

namespace fs = std::filesystem;

bool is_there(const fs::path& file) {
  std::error_code code;
  return fs::is_regular_file(file, code);
}

std::optional<SE3> to_pose(const std::vector<double>& values) {
  if (values.size() != 16) return std::nullopt;
  const Eigen::Matrix4d m = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(values.data());
  const SE3 pose(Eigen::Matrix3d(m.topLeftCorner<3, 3>()), m.topRightCorner<3, 1>());
  return pose.is_finite() ? std::optional(pose) : std::nullopt;
}

std::optional<SE3> read_t_bs(const fs::path& sensor_yaml) {
  try {
    return to_pose(YAML::LoadFile(sensor_yaml.string())["T_BS"]["data"].as<std::vector<double>>());
  } catch (const YAML::Exception&) {
    return std::nullopt;
  }
}

std::optional<SE3> read_imu_from_cam(const fs::path& camchain) {
  try {
    std::vector<double> values;
    for (const auto& row :
         YAML::LoadFile(camchain.string())["cam0"]["T_cam_imu"].as<std::vector<std::vector<double>>>())
      values.insert(values.end(), row.begin(), row.end());
    const std::optional<SE3> cam_from_imu = to_pose(values);
    return cam_from_imu ? std::optional(cam_from_imu->inverse()) : std::nullopt;
  } catch (const YAML::Exception&) {
    return std::nullopt;
  }
}

}  // namespace

TrackedFrame read_tracked_frame(const fs::path& truth) {
  const fs::path sensor = truth.parent_path(), mav = sensor.parent_path();
  TrackedFrame result;
  result.asked = mav / "cam0" / "sensor.yaml";
  result.is_in_dataset = is_there(result.asked);
  std::optional<SE3> body_from_cam = read_t_bs(result.asked);
  for (const fs::path& camchain :
       {mav / "camchain.yaml", mav / ".." / "dso" / "camchain.yaml", mav / ".." / "camchain.yaml"}) {
    if (body_from_cam || !is_there(camchain)) continue;
    result.is_in_dataset = true;
    body_from_cam = read_imu_from_cam(camchain);
  }
  if (!body_from_cam) return result;
  const std::optional<SE3> body_from_tracked = read_t_bs(sensor / "sensor.yaml");
  result.tracked_from_cam = body_from_tracked ? body_from_tracked->inverse() * *body_from_cam : *body_from_cam;
  return result;
}

}  // namespace rumi
