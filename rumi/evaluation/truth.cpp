// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/evaluation/truth.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "base/file_access.h"
#include "rumi/evaluation/body_frame.h"
#include "rumi/evaluation/text_fields.h"
#include "rumi/evaluation/truth_table.h"
#include "slam/numeric/median.h"

namespace rumi::tool {
namespace {

namespace fs = std::filesystem;

constexpr double kLatestNumber = 1e8;  // as seconds three years; more is no number of an image

constexpr const char* kColmap =
    "is of a model of COLMAP, whose images.txt has the world as each camera sees it, and no times: write the cameras' "
    "poses as TUM's lines (time tx ty tz qx qy qz qw), with the inverse of each";

struct Unit {
  const char* name;
  double per_second;
  double least;  // a time since 1970 is more than this, and less than the next unit's
};
constexpr Unit kUnits[] = {
    {"seconds", 1, 0}, {"milliseconds", 1e3, 1e11}, {"microseconds", 1e6, 1e14}, {"nanoseconds", 1e9, 1e17}};

struct RawTime {
  double value = 0;
  std::optional<int64_t> whole;  // nanoseconds since 1970 have more digits than a double
};

struct RawPose {
  size_t index = 0;  // of its line among those of the table
  RawTime time;
  SE3 pose;
};

std::optional<RawTime> parse_time(const std::string& text) {
  const std::optional<double> value = to_number(text);
  if (!value) return std::nullopt;
  RawTime time{*value, std::nullopt};
  int64_t whole = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), whole);
  if (error == std::errc() && end == text.data() + text.size()) time.whole = whole;
  return time;
}

// Nothing where it is too far from 0 for the difference of two times.
std::optional<int64_t> to_us(const RawTime& time, double per_second) {
  if (!(std::abs(time.value / per_second * 1e6) < 0x1p53)) return std::nullopt;
  if (time.whole && per_second == 1e9) return *time.whole / 1000;
  if (time.whole && per_second == 1e6) return *time.whole;
  return std::llround(time.value / per_second * 1e6);
}

// Reads one line after another, and counts what is no pose.
class LineReader {
 public:
  LineReader(const TruthTable& table, const TruthColumns& columns) : table_(table), columns_(columns) {}

  std::vector<RawPose> read() {
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
  size_t skipped() const { return skipped_; }
  const std::string& first() const { return first_; }  // "line 1, nan"

 private:
  std::optional<double> number(const std::string& field) {
    const std::optional<double> value = to_number(field);
    if (!value && why_.empty()) why_ = fmt::format("{}{}", field.substr(0, 20), field.size() > 20 ? "..." : "");
    return value;
  }
  std::optional<Eigen::Vector3d> vector(const std::vector<std::string>& fields, const std::array<size_t, 3>& at) {
    Eigen::Vector3d v;
    for (int k = 0; k < 3; ++k) {
      const std::optional<double> value = number(fields[at[k]]);
      if (!value) return std::nullopt;
      v[k] = *value;
    }
    if (is_position(v)) return v;
    return std::nullopt;
  }
  bool is_position(const Eigen::Vector3d& v) {
    const bool is_one = v.cwiseAbs().maxCoeff() <= kLargestPosition;
    if (!is_one) why_ = fmt::format("{:g}, {:g}, {:g} is no position", v.x(), v.y(), v.z());
    return is_one;
  }
  std::optional<SE3> read_quaternion(const std::vector<std::string>& fields, const Eigen::Vector3d& position) {
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
  std::optional<SE3> read_matrix(const std::vector<std::string>& fields) {
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
  std::optional<RawPose> read_line(const std::vector<std::string>& fields) {
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

  const TruthTable& table_;
  TruthColumns columns_;
  size_t skipped_ = 0;
  std::string first_, why_;
};

double median_step(std::vector<RawPose> poses) {
  std::sort(poses.begin(), poses.end(), [](const RawPose& a, const RawPose& b) { return a.time.value < b.time.value; });
  std::vector<double> steps;
  for (size_t i = 1; i < poses.size(); ++i)
    if (poses[i].time.value > poses[i - 1].time.value) steps.push_back(poses[i].time.value - poses[i - 1].time.value);
  return steps.empty() ? 0 : median(&steps);
}

// Numbers of the lines that lie alone, far from those before and behind them: where a tracker slipped for a moment.
std::vector<int> lines_apart(const TruthTable& table, const std::vector<RawPose>& poses) {
  constexpr double kUsualSteps = 100;  // it is so many of them away
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

bool are_small_and_whole(const std::vector<RawPose>& poses) {
  return std::all_of(poses.begin(), poses.end(),
                     [](const RawPose& pose) { return pose.time.whole && std::abs(pose.time.value) < kLatestNumber; });
}

// 1, 2, 3, ...: seconds only where the images are a second apart, too.
bool are_numbers_of_images(const std::vector<RawPose>& poses, const TruthOptions& options) {
  if (!options.run || poses.size() < 3 || !are_small_and_whole(poses) || median_step(poses) != 1) return false;
  return options.run->period_us < 500'000 || options.run->period_us > 2'000'000;
}

// That of the times' size; or, where they are not since 1970, the one in which they are those of the images.
const Unit& unit_of(const std::vector<RawPose>& poses, const TruthOptions& options) {
  const auto [first, last] = std::minmax_element(
      poses.begin(), poses.end(), [](const RawPose& a, const RawPose& b) { return a.time.value < b.time.value; });
  const double begin = first->time.value, end = last->time.value, step = median_step(poses);
  const Unit* by_size = &kUnits[0];
  for (const Unit& unit : kUnits)
    if (begin >= unit.least) by_size = &unit;
  if (!options.run) return *by_size;
  const auto overlaps = [&](const Unit& unit) {
    const double us = 1e6 / unit.per_second;
    return begin * us <= static_cast<double>(options.run->last_us) &&
           end * us >= static_cast<double>(options.run->first_us);
  };
  const auto is_usual_step = [&](const Unit& unit) {
    return step / unit.per_second > 2e-4 && step / unit.per_second < 20;
  };
  if (overlaps(*by_size) && is_usual_step(*by_size)) return *by_size;
  for (const Unit& unit : kUnits)
    if (overlaps(unit) && is_usual_step(unit)) return unit;
  return *by_size;
}

// KITTI's times.txt, a second a line: beside the poses, above them, or in the sequence of the same number.
std::optional<std::vector<double>> read_times(const fs::path& truth, std::string* file) {
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

// Every quaternion is zero, or nan: whoever wrote it had positions only.
bool has_no_rotation(const TruthTable& table, const TruthColumns& columns) {
  return std::all_of(table.lines.begin(), table.lines.end(), [&columns](const TruthLine& line) {
    return std::all_of(columns.quaternion->begin(), columns.quaternion->end(), [&line](size_t column) {
      return column < line.fields.size() && to_number(line.fields[column]).value_or(0) == 0;
    });
  });
}

// Lines of ten fields whose last one is the name of an image; those between them are of its points.
bool are_images_of_colmap(const TruthTable& table) {
  const auto is_image = [](const TruthLine& line) {
    return line.fields.size() == 10 && !to_number(line.fields[9]) && line.fields[9].find('.') != std::string::npos;
  };
  const auto images = std::count_if(table.lines.begin(), table.lines.end(), is_image);
  return images > 0 && 3 * static_cast<size_t>(images) >= table.lines.size();
}

class TruthReader {
 public:
  TruthReader(std::string file, const TruthOptions& options) : file_(std::move(file)), options_(options) {}

  TruthFile read() {
    if (const std::string stranger = known_stranger(); !stranger.empty()) return refuse(stranger);
    const std::optional<TruthTable> table = read_truth_table(file_);
    if (!table) {
      const std::string why = why_unreadable(file_, "give the file of the true poses");
      return refuse(why.empty() ? "is no file that can be read" : why);
    }
    if (are_images_of_colmap(*table)) return refuse(kColmap);
    if (table->lines.empty()) return refuse("holds no poses: give the file of the true poses");
    const bool has_names_of_euroc = std::any_of(table->names.begin(), table->names.end(), [](const std::string& name) {
      return name.find("_rs_") != std::string::npos;
    });
    const std::string& first = table->lines[0].fields.empty() ? file_ : table->lines[0].fields[0];
    const bool are_nanoseconds = first.size() >= 18 && first.find_first_not_of("0123456789") == std::string::npos;
    is_euroc_ = has_names_of_euroc || (table->has_commas && are_nanoseconds && table->names.size() != table->columns);
    std::string problem;
    std::optional<TruthColumns> columns = find_columns(*table, is_euroc_, &problem);
    if (!columns) return refuse(problem);
    std::vector<RawPose> raw = read_lines(*table, &*columns);
    if (raw.empty()) return std::move(result_);
    tell_of_jumps(lines_apart(*table, raw));
    set_times(*columns, table->lines.size(), raw);
    if (!result_.ok()) return std::move(result_);
    sort_by_time();
    if (is_euroc_) move_to_camera();
    return std::move(result_);
  }

 private:
  TruthFile refuse(const std::string& why) {
    result_.error = fmt::format("{}: {}", file_, why);
    return result_;
  }
  // What is no text of poses, and is known all the same.
  std::string known_stranger() const {
    std::error_code code;
    if (fs::is_directory(file_, code))
      return fs::exists(fs::path(file_) / "data.csv", code) ? "is a folder: give the data.csv in it"
                                                            : "is a folder: give the file of the true path in it";
    std::ifstream in(file_, std::ios::binary);
    std::string head(500, '\0');
    in.read(head.data(), static_cast<std::streamsize>(head.size()));
    head.resize(static_cast<size_t>(in.gcount()));
    const auto begins = [&head](const char* sign) { return head.starts_with(sign); };
    if (begins("#ROSBAG") || begins("\x89MCAP") || begins("SQLite format"))
      return "is a bag of ROS: write its poses as TUM's lines (time tx ty tz qx qy qz qw), as evo_traj --save_as_tum "
             "does";
    if (begins("PK") || begins("\x93NUMPY")) return "is an archive, or a file of NumPy: write its poses as TUM's lines";
    if (begins("\xFF\xFE") || begins("\xFE\xFF")) return "is UTF-16 (as PowerShell writes it): save it as UTF-8";
    if (head.find("IMAGE_ID") != std::string::npos || head.find("POINT3D_ID") != std::string::npos) return kColmap;
    if (begins("{")) return "is JSON: write its poses as TUM's lines (time tx ty tz qx qy qz qw)";
    return "";
  }
  void note(const std::string& what) { result_.notes.push_back(fmt::format("{}: {}", file_, what)); }

  std::vector<RawPose> read_lines(const TruthTable& table, TruthColumns* columns) {
    if (columns->quaternion && has_no_rotation(table, *columns)) columns->quaternion.reset();
    result_.has_rotations = columns->quaternion || columns->matrix;
    LineReader reader(table, *columns);
    std::vector<RawPose> raw = reader.read();
    if (raw.empty())
      refuse(fmt::format("none of {} lines is a pose (first: {})", table.lines.size(), reader.first()));
    else if (reader.skipped() > 0)
      note(
          fmt::format("{} of {} lines are no poses (first: {})", reader.skipped(), table.lines.size(), reader.first()));
    if (!result_.has_rotations) tell_of_positions(table, *columns);
    return raw;
  }

  void tell_of_jumps(const std::vector<int>& lines) {
    if (lines.empty()) return;
    note(fmt::format(
        "{} of its positions {} more than 100 usual steps away from those before and behind (first: line {}): if the "
        "tracker slipped there, remove such lines",
        lines.size(), lines.size() == 1 ? "is" : "are", lines[0]));
  }

  void tell_of_positions(const TruthTable& table, const TruthColumns& columns) {
    note(table.columns > columns.count() && table.columns < 8
             ? fmt::format("has positions and no rotations; what is behind them in its {} columns is not used",
                           table.columns)
             : std::string("has positions and no rotations"));
  }

  void add(const RawPose& raw, const std::optional<int64_t>& utime_us) {
    if (utime_us)
      result_.poses.push_back({*utime_us, raw.pose});
    else
      ++without_time_;
  }

  void set_times(const TruthColumns& columns, size_t lines, const std::vector<RawPose>& raw) {
    if (!columns.time) {
      set_times_by_line(lines, raw);
    } else if (options_.frames_per_second > 0) {
      set_times_by_rate(raw);
    } else if (are_numbers_of_images(raw, options_)) {
      refuse(fmt::format(
          "the first column counts {:.0f}, {:.0f}, ...: these are numbers of images, and no times; give the "
          "rate of the images with --groundtruth-rate HZ",
          raw[0].time.value, raw[1].time.value));
    } else {
      set_times_by_unit(raw);
    }
    if (without_time_ > 0) note(fmt::format("{} lines have a time that is out of all bounds: left out", without_time_));
    if (result_.ok() && result_.poses.empty()) refuse("no line has a time that is one");
  }

  void set_times_by_line(size_t lines, const std::vector<RawPose>& raw) {
    std::string file;
    if (options_.frames_per_second > 0) {
      for (const RawPose& pose : raw) add(pose, at_rate(static_cast<double>(pose.index)));
      return note(fmt::format("has no times: its lines are taken for images at {:.6g} Hz", options_.frames_per_second));
    }
    const std::optional<std::vector<double>> times = read_times(file_, &file);
    if (!times) {
      refuse(
          "its lines have no times (as KITTI's 12 numbers of a matrix): give the rate of the images with "
          "--groundtruth-rate HZ, or put the sequence's times.txt beside it");
      return;
    }
    if (times->size() != lines) {
      refuse(fmt::format("has {} lines, and {} has {} times: one for each is needed", lines, file, times->size()));
      return;
    }
    for (const RawPose& pose : raw) add(pose, to_us({(*times)[pose.index], std::nullopt}, 1));
    note(fmt::format("has no times: they are those of {}", file));
  }

  // Images whose times are not since 1970 begin at 0, wherever they are played from.
  std::optional<int64_t> at_rate(double number) const {
    const bool since_1970 = options_.run && options_.run->first_us > 1e14;
    const std::optional<int64_t> since_first = to_us({number, std::nullopt}, options_.frames_per_second);
    if (!since_first) return std::nullopt;
    return *since_first + (since_1970 ? options_.run->first_us : 0);
  }

  void set_times_by_rate(const std::vector<RawPose>& raw) {
    if (!are_small_and_whole(raw))
      return void(
          refuse(fmt::format("--groundtruth-rate is given, and the first column ({:.6f}) does not count images: it has "
                             "times; leave the option out",
                             raw[0].time.value)));
    for (const RawPose& pose : raw) add(pose, at_rate(pose.time.value));
  }

  void set_times_by_unit(const std::vector<RawPose>& raw) {
    const Unit& unit = unit_of(raw, options_);
    for (const RawPose& pose : raw) add(pose, to_us(pose.time, unit.per_second));
    const bool is_known = unit.per_second == 1 || (is_euroc_ && unit.per_second == 1e9);
    if (!is_known) note(fmt::format("its times are {}", unit.name));
    if (are_small_and_whole(raw))
      result_.hint = "its first column has whole numbers: if these are numbers of images, give --groundtruth-rate HZ";
  }

  void sort_by_time() {
    auto& poses = result_.poses;
    const auto earlier = [](const TimedPose& a, const TimedPose& b) { return a.utime_us < b.utime_us; };
    size_t back = 0;
    for (size_t i = 1; i < poses.size(); ++i) back += earlier(poses[i], poses[i - 1]);
    std::stable_sort(poses.begin(), poses.end(), earlier);
    const auto end = std::unique(poses.begin(), poses.end(), [](auto& a, auto& b) { return a.utime_us == b.utime_us; });
    const auto doubled = poses.end() - end;
    poses.erase(end, poses.end());
    if (back > 0) note(fmt::format("its times go back {} times: sorted", back));
    if (doubled > 0) note(fmt::format("{} poses have a time that another one has: the first of each is kept", doubled));
  }

  // EuRoC's truth is of the body, or of a marker on it.
  void move_to_camera() {
    if (!result_.has_rotations) return note("they are of the tracked point (a prism or marker), and not of the camera");
    const TrackedFrame tracked = read_tracked_frame(file_);
    if (tracked.tracked_from_cam) {
      for (TimedPose& pose : result_.poses) pose.map_from_cam = pose.map_from_cam * *tracked.tracked_from_cam;
      return;
    }
    if (!tracked.is_in_dataset) {
      refuse(fmt::format(
          "EuRoC's truth is of the body, and {} with T_BS (16 numbers), which says where the camera is on it, "
          "cannot be read: keep the truth in its place in the dataset's folder; if it is of the camera, name "
          "its columns in the first line: time,tx,ty,tz,qw,qx,qy,qz",
          tracked.asked.string()));
      return;
    }
    note(fmt::format(
        "taken as the path of the body: {} has no T_BS, which would say where the camera is on it; so errors of "
        "some centimetres are of that, and rotations are not compared",
        tracked.asked.string()));
    result_.has_rotations = false;
    for (TimedPose& pose : result_.poses) pose.map_from_cam.rotation.setIdentity();
  }

  std::string file_;
  TruthOptions options_;
  TruthFile result_;
  bool is_euroc_ = false;
  int without_time_ = 0;
};

}  // namespace

TruthFile read_groundtruth(const std::string& file, const TruthOptions& options) {
  return TruthReader(file, options).read();
}

}  // namespace rumi::tool
