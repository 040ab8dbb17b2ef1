// SPDX-License-Identifier: BSD-3-Clause
#include "formats/truth/truth_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text/number_text.h"
#include "formats/truth/text_fields.h"
#include "slam/numeric/median.h"

namespace rumi {
namespace {

std::optional<RawTime> parse_time(const std::string& text) {
  const std::optional<double> value = to_number(text);
  if (!value) return std::nullopt;
  return RawTime{*value, parse_number<int64_t>(text)};
}

}  // namespace

std::vector<RawPose> LineReader::read() {
  std::vector<RawPose> poses;
  for (size_t i = 0; i < table_.lines.size(); ++i) {
    why_ = "";
    const std::optional<RawPose> pose = read_line(table_.lines[i].fields);
    if (pose) {
      poses.push_back(*pose);
      poses.back().index = i;
    } else if (++skipped_ == 1) {
      first_ = fmt::format("line {}, {}", table_.lines[i].number, why_);
    }
  }
  return poses;
}

std::optional<double> LineReader::number(const std::string& field) {
  const std::optional<double> value = to_number(field);
  if (!value && why_.empty()) why_ = fmt::format("{}{}", field.substr(0, 20), field.size() > 20 ? "..." : "");
  return value;
}

std::optional<Eigen::Vector3d> LineReader::vector(const std::vector<std::string>& fields,
                                                  const std::array<size_t, 3>& at) {
  Eigen::Vector3d v;
  for (int k = 0; k < 3; ++k) {
    const std::optional<double> value = number(fields[at[k]]);
    if (!value) return std::nullopt;
    v[k] = *value;
  }
  if (is_position(v)) return v;
  return std::nullopt;
}

bool LineReader::is_position(const Eigen::Vector3d& v) {
  const bool is_one = v.cwiseAbs().maxCoeff() <= kLargestPosition;
  if (!is_one) why_ = fmt::format("{:g}, {:g}, {:g} is no position", v.x(), v.y(), v.z());
  return is_one;
}

std::optional<SE3> LineReader::read_quaternion(const std::vector<std::string>& fields,
                                               const Eigen::Vector3d& position) {
  double q[4];
  for (int k = 0; k < 4; ++k) {
    const std::optional<double> value = number(fields[(*columns_.quaternion)[k]]);
    if (!value) return std::nullopt;
    q[k] = *value;
  }
  const Eigen::Quaterniond rotation(q[0], q[1], q[2], q[3]);
  if (std::abs(rotation.norm() - 1) <= 0.01) return SE3(rotation, position);
  why_ = fmt::format("its quaternion has the length {:.3g}", rotation.norm());
  return std::nullopt;
}

std::optional<SE3> LineReader::read_matrix(const std::vector<std::string>& fields) {
  Eigen::Matrix<double, 3, 4> m;
  for (int k = 0; k < 12; ++k) {
    const std::optional<double> value = number(fields[*columns_.matrix + k]);
    if (!value) return std::nullopt;
    m(k / 4, k % 4) = *value;
  }
  const Eigen::Matrix3d r = m.leftCols<3>();
  const bool is_rotation = (r * r.transpose() - Eigen::Matrix3d::Identity()).norm() < 0.02 && r.determinant() > 0;
  if (is_rotation && !is_position(m.col(3))) return std::nullopt;
  if (is_rotation) return SE3(r, m.col(3));
  why_ = "its matrix is no rotation";
  return std::nullopt;
}

std::optional<RawPose> LineReader::read_line(const std::vector<std::string>& fields) {
  if (fields.size() < columns_.count()) {
    why_ = fmt::format("{} numbers instead of {}", fields.size(), columns_.count());
    return std::nullopt;
  }
  RawPose raw;
  if (columns_.time) {
    const std::optional<RawTime> time = parse_time(fields[*columns_.time]);
    if (!time) return number(fields[*columns_.time]), std::nullopt;
    raw.time = *time;
  }
  std::optional<SE3> pose;
  if (columns_.matrix) {
    pose = read_matrix(fields);
  } else if (const auto position = vector(fields, columns_.position)) {
    pose = columns_.quaternion ? read_quaternion(fields, *position)
                               : std::optional(SE3(Eigen::Quaterniond::Identity(), *position));
  }
  if (!pose) return std::nullopt;
  raw.pose = *pose;
  return raw;
}

std::vector<int> lines_apart(const TruthTable& table, const std::vector<RawPose>& poses) {
  constexpr double kUsualSteps = 100;  // a position this many usual steps from its neighbours is apart
  std::vector<double> steps;
  const auto distance = [&poses](size_t a, size_t b) {
    return (poses[a].pose.translation - poses[b].pose.translation).norm();
  };
  for (size_t i = 1; i < poses.size(); ++i) steps.push_back(distance(i - 1, i));
  if (steps.size() < 3) return {};
  const double farthest = kUsualSteps * median(&steps);
  std::vector<int> lines;
  for (size_t i = 0; farthest > 0 && i < poses.size(); ++i) {
    const size_t before = i > 0 ? i - 1 : 2, behind = i + 1 < poses.size() ? i + 1 : i - 2;
    if (std::min(distance(i, before), distance(i, behind)) > farthest && distance(before, behind) < farthest)
      lines.push_back(table.lines[poses[i].index].number);
  }
  return lines;
}

bool has_no_rotation(const TruthTable& table, const TruthColumns& columns) {
  return std::all_of(table.lines.begin(), table.lines.end(), [&columns](const TruthLine& line) {
    return std::all_of(columns.quaternion->begin(), columns.quaternion->end(), [&line](size_t column) {
      return column < line.fields.size() && to_number(line.fields[column]).value_or(0) == 0;
    });
  });
}

bool are_images_of_colmap(const TruthTable& table) {
  const auto is_image = [](const TruthLine& line) {
    return line.fields.size() == 10 && !to_number(line.fields[9]) && line.fields[9].find('.') != std::string::npos;
  };
  const auto images = std::count_if(table.lines.begin(), table.lines.end(), is_image);
  return images > 0 && 3 * static_cast<size_t>(images) >= table.lines.size();
}

}  // namespace rumi
