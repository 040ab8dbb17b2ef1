// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/model/map_association.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/memory/file_memory.h"
#include "base/running/stage_clock.h"
#include "map_server/model/point_cells.h"
#include "slam/features/keypoint_grid.h"
#include "slam/features/matching.h"

namespace rumi::map_server {
namespace {

constexpr double kMinOctave = -1.5;  // a point that would appear at a lower octave is too far away to be detected
constexpr int kVisitedAtOnce = 100;  // views whose features are in RAM at a time

// The appearance of a point in the views that observe it.
struct Look {
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  // mean of the unit vectors from the cameras
  double octave0_distance = 0;                          // distance at which it would be a keypoint of octave 0
};

class Associator {
 public:
  Associator(const AssociationOptions& options, MapModel* model)
      : o_(options), model_(*model), looks_(model->points.size()) {
    double factor = 1;  // largest scale factor of all views' pyramids
    for (const MapModel::View& view : model_.views) factor = std::max(factor, view.pyramid.scale_factor);
    std::vector<double> reach(looks_.size());
    for (size_t p = 0; p < looks_.size(); ++p) {
      looks_[p] = look_of(model_.points[p]);
      reach[p] = looks_[p].octave0_distance * std::pow(factor, -kMinOctave);
    }
    cells_ = PointCells(model_.points, reach);
  }

  AssociationReport run(const std::vector<int>& views) {
    int visited = 0;
    for (int v : views) {
      if (visited++ % kVisitedAtOnce == 0) FileMemory::of_process().let_go();
      const MapModel::View& view = model_.views[v];
      const KeypointGrid grid(view.features->undistorted, view.camera);
      for (int p : cells_.may_be_seen(view)) visit(p, v, grid);
    }
    return report_;
  }

 private:
  Look look_of(const MapModel::Point& point) const {
    Look look;
    for (const MapModel::Observation& o : point.observations) {
      const MapModel::View& view = model_.views[o.view];
      const Eigen::Vector3d ray = point.position - view.cam_from_map.center();
      look.direction += ray.normalized();
      const double scale = view.pyramid.scale(view.features->keypoints[o.keypoint].octave);
      look.octave0_distance = std::max(look.octave0_distance, ray.norm() * scale);
    }
    if (!point.observations.empty()) look.direction.normalize();
    return look;
  }

  bool sees(const MapModel::View& view, int p) const {
    const auto& observations = model_.points[p].observations;
    return std::any_of(observations.begin(), observations.end(),
                       [&](const MapModel::Observation& o) { return &model_.views[o.view] == &view; });
  }

  void visit(int p, int v, const KeypointGrid& grid) {
    const MapModel::Point& point = model_.points[p];
    const MapModel::View& view = model_.views[v];
    if (point.observations.size() < 2) return;
    const Eigen::Vector3d in_cam = view.cam_from_map * point.position;
    if (!(in_cam.z() > 0)) return;
    const Eigen::Vector2d pixel = view.camera.project_undistorted(in_cam);
    if (!view.camera.contains(pixel)) return;
    const double distance = in_cam.norm();
    const Eigen::Vector3d direction = view.cam_from_map.rotation.conjugate() * in_cam / distance;
    if (direction.dot(looks_[p].direction) < std::cos(o_.max_view_angle_deg * M_PI / 180)) return;
    const double octave = std::log(looks_[p].octave0_distance / distance) / std::log(view.pyramid.scale_factor);
    if (octave < kMinOctave || octave > view.pyramid.levels + 0.5 || sees(view, p)) return;
    const int keypoint = find(point.descriptor, view, grid, pixel, octave);
    if (keypoint == kNone) return;
    const int there = view.points[keypoint];
    if (there == kNone) {
      report_.observed += model_.observe(p, v, keypoint);
    } else if (may_fuse(p, there, view)) {
      model_.fuse(there, p);
      ++report_.fused;
    }
  }

  int find(const Descriptor& descriptor, const MapModel::View& view, const KeypointGrid& grid,
           const Eigen::Vector2d& pixel, double octave) const {
    const int nearest = std::clamp(static_cast<int>(std::lround(octave)), 0, view.pyramid.levels - 1);
    const double radius = o_.radius_px * view.pyramid.scale(nearest);
    BestMatch best;
    grid.for_each_near(pixel.cast<float>(), static_cast<float>(radius), [&](int i) {
      if (std::abs(view.features->keypoints[i].octave - octave) > 1.6) return;
      if ((view.features->undistorted[i].cast<double>() - pixel).norm() > radius) return;
      best.offer(hamming_distance(descriptor, view.features->descriptors[i]), i);
    });
    return best.distance <= o_.max_distance && best.distance <= o_.max_ratio * best.second_distance ? best.index
                                                                                                    : kNone;
  }

  // Two points that one image observes at different keypoints are different points.
  bool may_fuse(int a, int b, const MapModel::View& view) const {
    const double depth_a = (view.cam_from_map * model_.points[a].position).z();
    const double depth_b = (view.cam_from_map * model_.points[b].position).z();
    if (!(depth_b > 0) || std::abs(std::log(depth_a / depth_b)) > o_.max_depth_ratio) return false;
    if (hamming_distance(model_.points[a].descriptor, model_.points[b].descriptor) > o_.max_distance) return false;
    return std::none_of(model_.points[a].observations.begin(), model_.points[a].observations.end(),
                        [&](const MapModel::Observation& o) { return sees(model_.views[o.view], b); });
  }

  const AssociationOptions& o_;
  MapModel& model_;
  std::vector<Look> looks_;
  PointCells cells_;
  AssociationReport report_;
};

}  // namespace

AssociationReport associate(const AssociationOptions& options, const std::vector<int>& views, MapModel* model) {
  const StageClock clock("map_server.associate");
  std::vector<int> all(views.empty() ? model->views.size() : 0);
  std::iota(all.begin(), all.end(), 0);
  return Associator(options, model).run(views.empty() ? all : views);
}

}  // namespace rumi::map_server
