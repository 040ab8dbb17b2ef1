// SPDX-License-Identifier: BSD-3-Clause
// Reads the lines of a truth as poses, with the times as they are written.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "formats/truth/truth_table.h"
#include "slam/geometry/transform.h"

namespace rumi {

struct RawTime {
  double value = 0;
  std::optional<int64_t> whole;  // the value, if it is whole: nanoseconds since 1970 have more digits than a double
};

struct RawPose {
  size_t index = 0;  // number of its line in the table
  RawTime time;
  SE3 pose;
};

// Reads one line after another, and counts those that are no pose.
class LineReader {
 public:
  LineReader(const TruthTable& table, const TruthColumns& columns) : table_(table), columns_(columns) {}

  std::vector<RawPose> read();
  size_t skipped() const { return skipped_; }
  const std::string& first() const { return first_; }  // the first line that is no pose: "line 1, nan"

 private:
  std::optional<double> number(const std::string& field);
  std::optional<Eigen::Vector3d> vector(const std::vector<std::string>& fields, const std::array<size_t, 3>& at);
  bool is_position(const Eigen::Vector3d& v);
  std::optional<SE3> read_quaternion(const std::vector<std::string>& fields, const Eigen::Vector3d& position);
  std::optional<SE3> read_matrix(const std::vector<std::string>& fields);
  std::optional<RawPose> read_line(const std::vector<std::string>& fields);

  const TruthTable& table_;
  TruthColumns columns_;
  size_t skipped_ = 0;
  std::string first_, why_;
};

// Returns the numbers of the lines whose positions lie far from those before and behind them: there the reference
// system was wrong for a moment.
std::vector<int> lines_apart(const TruthTable& table, const std::vector<RawPose>& poses);
// True if every quaternion is zero or no finite number (NaN): the writer had positions only.
bool has_no_rotation(const TruthTable& table, const TruthColumns& columns);
// True for COLMAP's images.txt: lines of ten fields that end with the name of an image; the lines between them hold its
// points.
bool are_images_of_colmap(const TruthTable& table);

}  // namespace rumi
