// SPDX-License-Identifier: BSD-3-Clause
#include "formats/truth/truth.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "base/files/file_access.h"
#include "formats/truth/body_frame.h"
#include "formats/truth/truth_lines.h"
#include "formats/truth/truth_table.h"
#include "formats/truth/truth_times.h"

namespace rumi {
namespace {

namespace fs = std::filesystem;

constexpr const char* kColmap =
    "is of a model of COLMAP, whose images.txt has the world as each camera sees it, and no times: write the cameras' "
    "poses as TUM's lines (time tx ty tz qx qy qz qw), with the inverse of each";

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
    if (file_.ends_with(kEndingOfIclNuim)) mirror_y();
    return std::move(result_);
  }

 private:
  TruthFile refuse(const std::string& why) {
    result_.error = fmt::format("{}: {}", file_, why);
    return result_;
  }
  // Recognizes files that are no text of poses. Returns what they are and what to do, or an empty string.
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
      return "is a bag of ROS: `rumi evaluate` reads the camera's poses in it, `rumi import` writes them as a file";
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
        "reference system was wrong there, remove such lines",
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

  // Returns the time of an image by its number, counted from 0; nullopt if it is out of all bounds. If the recording's
  // times are since 1970, image 0 has the first of them; else it has time 0.
  std::optional<int64_t> at_rate(double number) const {
    const bool since_1970 = options_.run && static_cast<double>(options_.run->first_us) > 1e14;
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
    const TimeUnit unit = unit_of(raw, options_);
    for (const RawPose& pose : raw) add(pose, to_us(pose.time, per_second(unit)));
    const bool is_known = unit == TimeUnit::kSeconds || (is_euroc_ && unit == TimeUnit::kNanoseconds);
    if (!is_known) note(fmt::format("its times are {}", name_of(unit)));
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

  void mirror_y() {
    note("of ICL-NUIM, whose y points up: mirrored, so that it points down as in the images");
    for (TimedPose& pose : result_.poses) {
      Eigen::Vector3d& t = pose.map_from_cam.translation;
      Eigen::Quaterniond& q = pose.map_from_cam.rotation;
      t.y() = -t.y();
      q.x() = -q.x(), q.z() = -q.z();  // a mirror also reverses the sense of rotation
    }
  }

  // Moves the poses to the camera: EuRoC's truth is the path of the body, or of a marker on it.
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

}  // namespace rumi
