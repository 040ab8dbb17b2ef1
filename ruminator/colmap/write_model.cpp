// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/colmap/write_model.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <limits>

#include "base/this_process/account_limits.h"

namespace rumi::ruminator {
namespace {

constexpr uint64_t kNoPoint = std::numeric_limits<uint64_t>::max();
constexpr int32_t kPinhole = 1;      // COLMAP's id of the camera model
constexpr double kPixelShift = 0.5;  // COLMAP's upper-left pixel has its centre at (0.5, 0.5)

class Writer {
 public:
  explicit Writer(const std::string& file) : name_(file), out_(file, std::ios::binary | std::ios::trunc) {}
  template <class T>
  Writer& put(const T& value) {
    out_.write(reinterpret_cast<const char*>(&value), sizeof(T));
    return *this;
  }
  Writer& put_text(const std::string& text) {
    out_.write(text.c_str(), static_cast<std::streamsize>(text.size() + 1));
    return *this;
  }
  Result<> finish() {
    out_.close();
    if (out_) return {};
    return Error{fmt::format("cannot be written: {}", write_error_text(errno)), name_};
  }

 private:
  std::string name_;
  std::ofstream out_;
};

Result<> write_camera(const std::string& file, const Camera& camera) {
  Writer out(file);
  out.put(uint64_t{1}).put(uint32_t{1}).put(kPinhole);
  out.put(static_cast<uint64_t>(camera.width)).put(static_cast<uint64_t>(camera.height));
  out.put(camera.fx).put(camera.fy).put(camera.cx + kPixelShift).put(camera.cy + kPixelShift);
  return out.finish();
}

Result<> write_images(const std::string& file, const std::vector<WindowImage>& images, const SparseModel& model) {
  std::vector<std::vector<uint64_t>> point_of;
  point_of.reserve(images.size());
  for (const WindowImage& image : images) point_of.emplace_back(image.keypoints.size(), kNoPoint);
  for (size_t p = 0; p < model.points.size(); ++p)
    for (const auto& [image, keypoint] : model.points[p].track) point_of[image][keypoint] = p + 1;

  Writer out(file);
  out.put(static_cast<uint64_t>(model.cam_from_world.size()));
  for (const auto& [index, pose] : model.cam_from_world) {
    const Eigen::Quaterniond& q = pose.rotation;
    out.put(static_cast<uint32_t>(index + 1)).put(q.w()).put(q.x()).put(q.y()).put(q.z());
    out.put(pose.translation.x()).put(pose.translation.y()).put(pose.translation.z());
    out.put(uint32_t{1}).put_text(images[index].name);
    out.put(static_cast<uint64_t>(images[index].keypoints.size()));
    for (size_t k = 0; k < images[index].keypoints.size(); ++k) {
      const Eigen::Vector2d pixel = images[index].keypoints[k].cast<double>();
      out.put(pixel.x() + kPixelShift).put(pixel.y() + kPixelShift).put(point_of[index][k]);
    }
  }
  return out.finish();
}

Result<> write_points(const std::string& file, const SparseModel& model) {
  Writer out(file);
  out.put(static_cast<uint64_t>(model.points.size()));
  for (size_t p = 0; p < model.points.size(); ++p) {
    const SparseModel::Point& point = model.points[p];
    out.put(static_cast<uint64_t>(p + 1)).put(point.position.x()).put(point.position.y()).put(point.position.z());
    out.put(uint8_t{0}).put(uint8_t{0}).put(uint8_t{0}).put(0.0);  // colour, error
    out.put(static_cast<uint64_t>(point.track.size()));
    for (const auto& [image, keypoint] : point.track)
      out.put(static_cast<uint32_t>(image + 1)).put(static_cast<uint32_t>(keypoint));
  }
  return out.finish();
}

}  // namespace

Result<> write_colmap_model(const std::string& folder, const Camera& camera, const std::vector<WindowImage>& images,
                            const SparseModel& model) {
  if (Result<> camera_file = write_camera(folder + "/cameras.bin", camera); !camera_file) return camera_file;
  if (Result<> images_file = write_images(folder + "/images.bin", images, model); !images_file) return images_file;
  return write_points(folder + "/points3D.bin", model);
}

}  // namespace rumi::ruminator
