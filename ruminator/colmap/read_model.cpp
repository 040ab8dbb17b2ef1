// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/colmap/read_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>
#include <system_error>

namespace rumi::ruminator {
namespace {

namespace fs = std::filesystem;

static_assert(std::endian::native == std::endian::little, "COLMAP's files are read as the numbers lie in them");

constexpr double kUnitLengthTolerance = 1e-6;  // largest deviation of a rotation quaternion's length from 1
constexpr size_t kLongestName = 4096;
constexpr uintmax_t kLargestFile = 1 << 30;  // bytes; the files of a window have a few megabytes
// The least size of an element in its file. A count that would need more bytes than are left is refused at once.
constexpr size_t kCameraBytes = 24;
constexpr size_t kImageBytes = 4 + 7 * 8 + 4 + 1 + 8;
constexpr size_t kKeypointBytes = 24;
constexpr size_t kPointBytes = 8 + 3 * 8 + 3 + 8 + 8;
constexpr size_t kTrackElementBytes = 8;

// The number of parameters of each camera model, by COLMAP's model id, from SIMPLE_PINHOLE to THIN_PRISM_FISHEYE.
constexpr std::array<int, 11> kParameterCounts = {3, 4, 4, 5, 8, 8, 12, 5, 4, 5, 12};
constexpr std::array<int, 5> kModelsWithOneFocalLength = {0, 2, 3, 8, 9};

// Thrown by the nested readers; read_colmap_model() turns it into an Error.
struct Corrupt {
  Error error;
};

class Reader {
 public:
  explicit Reader(const std::string& file) : name_(file) {
    std::error_code error;
    const uintmax_t size = fs::file_size(file, error);
    if (error) throw Corrupt{{error.message(), file}};
    if (size > kLargestFile) throw Corrupt{{fmt::format("{} bytes are too many", size), file}};
    bytes_.resize(size);
    std::ifstream in(file, std::ios::binary);
    if (!in.read(bytes_.data(), static_cast<std::streamsize>(size))) throw Corrupt{{std::strerror(errno), file}};
  }
  template <class T>
  T take() {
    if (left() < sizeof(T)) fail("the file ends too early");
    T value;
    std::memcpy(&value, bytes_.data() + position_, sizeof(T));
    position_ += sizeof(T);
    return value;
  }
  double number() {
    const auto value = take<double>();
    if (!std::isfinite(value)) fail("a number is not finite");
    return value;
  }
  Eigen::Vector3d vector() {
    const double x = number(), y = number(), z = number();
    return {x, y, z};
  }
  size_t count(size_t element_bytes) {
    const auto n = take<uint64_t>();
    if (n > left() / element_bytes) fail(fmt::format("the file is too short for {} elements", n));
    return static_cast<size_t>(n);
  }
  void skip_text() {
    const size_t end = bytes_.find('\0', position_);
    if (end == std::string::npos || end - position_ > kLongestName) fail("a name has no end");
    position_ = end + 1;
  }
  void expect_end() {
    if (left() > 0) fail(fmt::format("{} bytes too many", left()));
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw Corrupt{{fmt::format("{} (byte {})", what, position_), name_}};
  }

 private:
  size_t left() const { return bytes_.size() - position_; }

  std::string name_, bytes_;
  size_t position_ = 0;
};

void read_cameras(Reader in, SparseModel* model) {
  const size_t cameras = in.count(kCameraBytes);
  if (cameras != 1) in.fail(fmt::format("{} cameras instead of the one it was given", cameras));
  in.take<uint32_t>();  // the camera's id
  const auto kind = in.take<int32_t>();
  if (kind < 0 || static_cast<size_t>(kind) >= kParameterCounts.size()) in.fail(fmt::format("camera model {}", kind));
  in.take<uint64_t>();  // width
  in.take<uint64_t>();  // height
  std::array<double, 12> parameters{};
  for (int i = 0; i < kParameterCounts[static_cast<size_t>(kind)]; ++i)
    parameters[static_cast<size_t>(i)] = in.number();
  const bool one = std::find(kModelsWithOneFocalLength.begin(), kModelsWithOneFocalLength.end(), kind) !=
                   kModelsWithOneFocalLength.end();
  model->fx = parameters[0];
  model->fy = one ? parameters[0] : parameters[1];
  if (!(model->fx > 0) || !(model->fy > 0)) in.fail(fmt::format("focal lengths {}, {}", model->fx, model->fy));
  in.expect_end();
}

// Reads COLMAP's id of an image and returns the index of that image.
int take_image(Reader& in, const std::vector<int>& keypoint_counts) {
  const auto id = in.take<uint32_t>();
  if (id == 0 || id > keypoint_counts.size()) in.fail(fmt::format("image {} of {}", id, keypoint_counts.size()));
  return static_cast<int>(id - 1);
}

SE3 take_pose(Reader& in) {
  const double w = in.number();
  const Eigen::Vector3d v = in.vector(), t = in.vector();
  const Eigen::Quaterniond q(w, v.x(), v.y(), v.z());
  if (std::abs(q.norm() - 1) > kUnitLengthTolerance) in.fail(fmt::format("a rotation of length {}", q.norm()));
  return {q, t};
}

void read_images(Reader in, const std::vector<int>& keypoint_counts, SparseModel* model) {
  const size_t images = in.count(kImageBytes);
  for (size_t i = 0; i < images; ++i) {
    const int image = take_image(in, keypoint_counts);
    const SE3 pose = take_pose(in);
    if (!model->cam_from_world.emplace(image, pose).second) in.fail(fmt::format("image {} is there twice", image + 1));
    in.take<uint32_t>();  // the camera's id; there is only one camera
    in.skip_text();
    const size_t keypoints = in.count(kKeypointBytes);
    if (keypoints != static_cast<size_t>(keypoint_counts[static_cast<size_t>(image)]))
      in.fail(fmt::format("{} keypoints instead of {}", keypoints, keypoint_counts[static_cast<size_t>(image)]));
    for (size_t k = 0; k < keypoints; ++k) {
      in.number();
      in.number();
      in.take<uint64_t>();  // the point that it sees; points3D.bin says so too
    }
  }
  in.expect_end();
}

using Track = std::vector<std::pair<int, int>>;

// Reads the track of a point. `used`: keypoints of earlier points; each keypoint may see only one point.
Track take_track(Reader& in, const std::vector<int>& keypoint_counts, const SparseModel& model,
                 std::set<std::pair<int, int>>* used) {
  Track track;
  const size_t length = in.count(kTrackElementBytes);
  track.reserve(length);
  for (size_t i = 0; i < length; ++i) {
    const int image = take_image(in, keypoint_counts);
    const auto keypoint = in.take<uint32_t>();
    if (!model.cam_from_world.contains(image)) in.fail(fmt::format("image {} is not registered", image + 1));
    const int keypoints = keypoint_counts[static_cast<size_t>(image)];
    if (keypoint >= static_cast<uint32_t>(std::max(keypoints, 0)))
      in.fail(fmt::format("keypoint {} of {} in image {}", keypoint, keypoints, image + 1));
    track.emplace_back(image, static_cast<int>(keypoint));
    if (!used->insert(track.back()).second)
      in.fail(fmt::format("keypoint {} of image {} sees two points", keypoint, image + 1));
  }
  return track;
}

void read_points(Reader in, const std::vector<int>& keypoint_counts, SparseModel* model) {
  std::map<uint64_t, SparseModel::Point> points;
  std::set<std::pair<int, int>> used;
  const size_t count = in.count(kPointBytes);
  for (size_t i = 0; i < count; ++i) {
    const auto id = in.take<uint64_t>();
    SparseModel::Point point;
    point.position = in.vector();
    in.take<std::array<uint8_t, 3>>();  // colour
    in.take<double>();                  // error; NaN in a model without bundle adjustment
    point.track = take_track(in, keypoint_counts, *model, &used);
    if (!points.emplace(id, std::move(point)).second) in.fail(fmt::format("point {} is there twice", id));
  }
  in.expect_end();
  model->points.reserve(points.size());
  for (auto& [id, point] : points) model->points.push_back(std::move(point));
}

}  // namespace

Result<SparseModel> read_colmap_model(const std::string& folder, const std::vector<int>& keypoint_counts) {
  SparseModel model;
  try {
    read_cameras(Reader(folder + "/cameras.bin"), &model);
    read_images(Reader(folder + "/images.bin"), keypoint_counts, &model);
    read_points(Reader(folder + "/points3D.bin"), keypoint_counts, &model);
  } catch (const Corrupt& corrupt) {
    return corrupt.error;
  }
  return model;
}

std::vector<std::string> colmap_model_folders(const std::string& folder) {
  std::vector<std::string> folders;
  for (int i = 0;; ++i) {
    const std::string name = fmt::format("{}/{}", folder, i);
    std::error_code error;
    if (!fs::is_directory(name, error)) return folders;
    folders.push_back(name);
  }
}

}  // namespace rumi::ruminator
