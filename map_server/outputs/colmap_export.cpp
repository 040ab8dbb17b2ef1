// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/outputs/colmap_export.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <utility>
#include <vector>

#include "base/files/whole_file.h"
#include "map_server/alignment/correspondences.h"
#include "map_server/model/map_model.h"
#include "map_server/outputs/trajectory_file.h"

namespace rumi::map_server {
namespace {

namespace fs = std::filesystem;

constexpr double kPixelShift = 0.5;  // COLMAP's pixel coordinates minus ours
constexpr int64_t kNoPoint = -1;

struct ColmapCamera {
  uint32_t id = 0;
  int32_t model = 0;
  std::string name;
  uint64_t width = 0, height = 0;
  std::vector<double> params;
};

struct ExportedImage {
  uint32_t id = 0, camera = 0;
  SE3 cam_from_map;
  std::string name;
  std::vector<std::pair<Eigen::Vector2d, int64_t>> points;  // pixel, point id or kNoPoint
};

struct ColmapPoint {
  int64_t id = 0;
  Eigen::Vector3d position;
  Colour colour;
  double error_px = 0;
  std::vector<std::pair<uint32_t, uint32_t>> track;  // image, index in its points
};

struct ColmapExport {
  std::vector<ColmapCamera> cameras;
  std::vector<ExportedImage> images;
  std::vector<ColmapPoint> points;
};

ColmapCamera make_camera(const Camera& c, uint32_t id) {
  ColmapCamera out{.id = id,
                   .model = 4,
                   .name = "OPENCV",
                   .width = static_cast<uint64_t>(c.width),
                   .height = static_cast<uint64_t>(c.height),
                   .params = {c.fx, c.fy, c.cx + kPixelShift, c.cy + kPixelShift, c.k1, c.k2}};
  if (c.model == Camera::Model::kKannalaBrandt) {
    out.model = 5, out.name = "OPENCV_FISHEYE";
    out.params.insert(out.params.end(), {c.k3, c.k4});
    return out;
  }
  out.params.insert(out.params.end(), {c.p1, c.p2});
  if (c.k3 != 0) {
    out.model = 6, out.name = "FULL_OPENCV";
    out.params.insert(out.params.end(), {c.k3, 0.0, 0.0, 0.0});
  }
  return out;
}

bool same_camera(const ColmapCamera& a, const ColmapCamera& b) {
  return a.model == b.model && a.width == b.width && a.height == b.height && a.params == b.params;
}

uint32_t camera_id(const Camera& camera, ColmapExport* model) {
  ColmapCamera made = make_camera(camera, static_cast<uint32_t>(model->cameras.size() + 1));
  for (const ColmapCamera& known : model->cameras)
    if (same_camera(known, made)) return known.id;
  model->cameras.push_back(std::move(made));
  return model->cameras.back().id;
}

// Returns the mean distance of a point's observations from its projections, in pixels.
double mean_error_px(const MapModel& map, const MapModel::Point& point) {
  double sum = 0;
  int count = 0;
  for (const MapModel::Observation& o : point.observations) {
    const MapModel::View& view = map.views[o.view];
    const auto pixel = view.camera.project(view.cam_from_map * point.position);
    if (!pixel) continue;
    sum += (*pixel - view.features->keypoints[o.keypoint].pixel.cast<double>()).norm();
    ++count;
  }
  return count > 0 ? sum / count : 0;
}

// Returns the colour of the point's first landmark that has one; the submap's colour if none has.
Colour colour_of_point(const MapModel::Point& point, const LandmarkColours& colours) {
  for (const LandmarkRef& landmark : point.landmarks)
    if (const auto seen = colours.find(landmark); seen != colours.end()) return seen->second;
  return submap_colour(point.landmarks.front().submap);
}

void add_point(const MapModel& map, const MapModel::Point& point, const LandmarkColours& colours, ColmapExport* model) {
  if (point.observations.size() < 2) return;
  ColmapPoint& out = model->points.emplace_back();
  out.id = static_cast<int64_t>(model->points.size());
  out.position = point.position;
  out.colour = colour_of_point(point, colours);
  out.error_px = mean_error_px(map, point);
  for (const MapModel::Observation& o : point.observations) {
    out.track.emplace_back(static_cast<uint32_t>(o.view + 1), static_cast<uint32_t>(o.keypoint));
    model->images[o.view].points[o.keypoint].second = out.id;
  }
}

MapModel joined(const Atlas& atlas) {
  std::map<SubmapKey, PlacedSubmap> placed;
  for (const auto& [key, owner] : atlas.submaps())
    if (owner.in_map) placed[key] = {&owner.submap, owner.placement};
  return join(placed, kSameKeypointPx);
}

std::vector<ImageId> images_of(const MapModel& map) {
  std::vector<ImageId> images;
  for (const MapModel::View& view : map.views) images.push_back(view.image);
  return images;
}

// Converts pixels of the working image to pixels of the image file, which is larger if max_image_side shrank the image.
class ToFile {
 public:
  ToFile(const Camera& tracked, const ImageFile* file) {
    if (!file) return;
    x_ = static_cast<double>(file->width) / tracked.width;
    y_ = static_cast<double>(file->height) / tracked.height;
    width_ = file->width, height_ = file->height;
  }
  // Returns the pixel in COLMAP's coordinates.
  Eigen::Vector2d operator()(const Eigen::Vector2d& pixel) const {
    return (pixel.array() + kPixelShift) * Eigen::Array2d(x_, y_);
  }
  Camera operator()(Camera camera) const {
    if (width_ == 0) return camera;
    const Eigen::Vector2d centre = (*this)({camera.cx, camera.cy});
    camera.cx = centre.x() - kPixelShift, camera.cy = centre.y() - kPixelShift;
    camera.fx *= x_, camera.fy *= y_;
    camera.width = width_, camera.height = height_;
    return camera;
  }

 private:
  double x_ = 1, y_ = 1;
  int width_ = 0, height_ = 0;
};

ColmapExport make_model(const Atlas& atlas, const LandmarkColours& colours, const ImageFiles& files) {
  const MapModel map = joined(atlas);
  const std::vector<ImageId> images = images_of(map);
  ColmapExport model;
  for (const MapModel::View& view : map.views) {
    const auto file = files.find(view.image);
    const ToFile to_file(view.camera, file == files.end() ? nullptr : &file->second);
    ExportedImage& image = model.images.emplace_back();
    image.id = static_cast<uint32_t>(model.images.size());
    image.camera = camera_id(to_file(view.camera), &model);
    image.cam_from_map = view.cam_from_map;
    image.name = file == files.end() ? colmap_name(view.image, images) : file->second.name;
    for (const Keypoint& keypoint : view.features->keypoints)
      image.points.emplace_back(to_file(keypoint.pixel.cast<double>()), kNoPoint);
  }
  for (const MapModel::Point& point : map.points) add_point(map, point, colours, &model);
  return model;
}

Result<> write_text(const ColmapExport& model, const fs::path& folder) {
  WholeFile cameras((folder / "cameras.txt").string());
  cameras.write("# CAMERA_ID MODEL WIDTH HEIGHT PARAMS[]\n");
  for (const ColmapCamera& c : model.cameras)
    cameras.write(fmt::format("{} {} {} {} {:.17g}\n", c.id, c.name, c.width, c.height, fmt::join(c.params, " ")));

  WholeFile images((folder / "images.txt").string());
  images.write("# IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME, then a line of X Y POINT3D_ID\n");
  for (const ExportedImage& i : model.images) {
    const Eigen::Quaterniond& q = i.cam_from_map.rotation;
    const Eigen::Vector3d& t = i.cam_from_map.translation;
    std::array<double, 7> pose{q.w(), q.x(), q.y(), q.z(), t.x(), t.y(), t.z()};
    for (double& value : pose) value += 0.0;  // so that no "-0" is written
    images.write(fmt::format("{} {:.17g} {} {}\n", i.id, fmt::join(pose, " "), i.camera, i.name));
    std::string line;
    for (const auto& [pixel, point] : i.points)
      fmt::format_to(std::back_inserter(line), "{}{:.9g} {:.9g} {}", line.empty() ? "" : " ", pixel.x(), pixel.y(),
                     point);
    images.write(line + "\n");
  }

  WholeFile points((folder / "points3D.txt").string());
  points.write("# POINT3D_ID X Y Z R G B ERROR TRACK[] as IMAGE_ID POINT2D_IDX\n");
  for (const ColmapPoint& p : model.points) {
    std::string line = fmt::format("{} {:.17g} {:.17g} {:.17g} {} {} {} {:.9g}", p.id, p.position.x(), p.position.y(),
                                   p.position.z(), p.colour.red, p.colour.green, p.colour.blue, p.error_px);
    for (const auto& [image, index] : p.track) fmt::format_to(std::back_inserter(line), " {} {}", image, index);
    points.write(line + "\n");
  }
  for (WholeFile* file : {&cameras, &images, &points})
    if (const Result<> written = file->commit(); !written) return written;
  return {};
}

void write_image(const ExportedImage& image, WholeFile* out) {
  out->write_value(image.id);
  const Eigen::Quaterniond& q = image.cam_from_map.rotation;
  for (const double value : {q.w(), q.x(), q.y(), q.z()}) out->write_value(value);
  for (int k = 0; k < 3; ++k) out->write_value(image.cam_from_map.translation[k]);
  out->write_value(image.camera);
  out->write({image.name.c_str(), image.name.size() + 1});
  out->write_value(static_cast<uint64_t>(image.points.size()));
  for (const auto& [pixel, point] : image.points) {
    out->write_value(pixel.x());
    out->write_value(pixel.y());
    out->write_value(static_cast<uint64_t>(point));
  }
}

Result<> write_binary(const ColmapExport& model, const fs::path& folder) {
  WholeFile cameras((folder / "cameras.bin").string());
  cameras.write_value(static_cast<uint64_t>(model.cameras.size()));
  for (const ColmapCamera& c : model.cameras) {
    cameras.write_value(c.id);
    cameras.write_value(c.model);
    cameras.write_value(c.width);
    cameras.write_value(c.height);
    for (const double value : c.params) cameras.write_value(value);
  }
  WholeFile images((folder / "images.bin").string());
  images.write_value(static_cast<uint64_t>(model.images.size()));
  for (const ExportedImage& image : model.images) write_image(image, &images);

  WholeFile points((folder / "points3D.bin").string());
  points.write_value(static_cast<uint64_t>(model.points.size()));
  for (const ColmapPoint& p : model.points) {
    points.write_value(static_cast<uint64_t>(p.id));
    for (int k = 0; k < 3; ++k) points.write_value(p.position[k]);
    for (const uint8_t channel : {p.colour.red, p.colour.green, p.colour.blue}) points.write_value(channel);
    points.write_value(p.error_px);
    points.write_value(static_cast<uint64_t>(p.track.size()));
    for (const auto& [image, index] : p.track) {
      points.write_value(image);
      points.write_value(index);
    }
  }
  for (WholeFile* file : {&cameras, &images, &points})
    if (const Result<> written = file->commit(); !written) return written;
  return {};
}

Result<> with_folder(const std::string& folder, const Atlas& atlas, const LandmarkColours& colours,
                     const ImageFiles& files, Result<> (*write)(const ColmapExport&, const fs::path&)) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return Error{fmt::format("cannot create {}: {}", folder, error.message())};
  return write(make_model(atlas, colours, files), folder);
}

}  // namespace

std::vector<ImageId> colmap_images(const Atlas& atlas) { return images_of(joined(atlas)); }

// Names an image by its time, and by its stream too if there are several, because their times may be the same.
std::string colmap_name(const ImageId& image, const std::vector<ImageId>& images) {
  const std::string name = seconds_text(image.utime_us) + ".jpg";
  const bool of_several_streams =
      std::any_of(images.begin(), images.end(), [&](const ImageId& other) { return other.stream != image.stream; });
  return of_several_streams ? fmt::format("{}/{}", image.stream, name) : name;
}

Result<> write_colmap_text(const Atlas& atlas, const std::string& folder, const LandmarkColours& colours,
                           const ImageFiles& files) {
  // In COLMAP's text format a name ends at the first space.
  for (const auto& [image, file] : files)
    if (file.name.find(' ') != std::string::npos)
      return Error{fmt::format("'{}' has a space, which no name in COLMAP's text may have: give --format colmap-bin",
                               file.name)};
  return with_folder(folder, atlas, colours, files, write_text);
}

Result<> write_colmap_binary(const Atlas& atlas, const std::string& folder, const LandmarkColours& colours,
                             const ImageFiles& files) {
  return with_folder(folder, atlas, colours, files, write_binary);
}

}  // namespace rumi::map_server
