// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/model/map_bundle.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <optional>

#include "base/memory/file_memory.h"
#include "map_server/model/covisible_pieces.h"
#include "slam/optimization/bundle_adjustment.h"

namespace rumi::map_server {
namespace {

// A view with fewer observations is not placed by them. Any pose fits three observations, and wrong ones do not stand
// out among a few. An image in which SIFT still finds features in the dark may have fewer ORB observations.
constexpr int kLeastToPlace = 15;

class Bundle {
 public:
  Bundle(const std::vector<int>& views, MapModel* model) : model_(*model) {
    index_of_view_.assign(model_.views.size(), kNone);
    for (int view : views) add_view(view, model_.views[view].fixed);
    std::vector<char> wanted(model_.points.size(), 0);
    for (int view : views)
      for (int point : model_.views[view].points)
        if (point != kNone) wanted[point] = 1;
    size_t observations = 0;
    for (size_t point = 0; point < wanted.size(); ++point)
      if (wanted[point]) observations += model_.points[point].observations.size();
    problem_.observations.reserve(observations);
    for (size_t point = 0; point < wanted.size(); ++point)
      if (wanted[point]) add_point(static_cast<int>(point));
    const auto is_fixed = [](const BundleProblem::View& view) { return view.fixed; };
    if (!problem_.views.empty() && std::none_of(problem_.views.begin(), problem_.views.end(), is_fixed))
      problem_.views.front().fixed = true;
  }

  MapBundleReport run(const MapBundleOptions& options) {
    MapBundleReport report;
    BundleSolver own;
    BundleSolver& solver = options.solver ? *options.solver : own;
    FileMemory::of_process().let_go();  // the problem has all that is needed of it
    for (size_t round = 0; round < options.gates_chi2.size(); ++round) {
      const bool is_last = round + 1 == options.gates_chi2.size();
      solver.solve(camera_,
                   {.iterations = options.iterations,
                    .function_tolerance = is_last ? options.function_tolerance : options.passing_tolerance,
                    .cancel = options.cancel},
                   &problem_, within(options.gates_chi2[round]));
    }
    report.views = static_cast<int>(free_views_);
    report.points = static_cast<int>(problem_.points.size());
    if (!options.gates_chi2.empty()) apply(options.gates_chi2.back(), &report);
    return report;
  }

 private:
  void add_view(int view, bool fixed) {
    index_of_view_[view] = static_cast<int>(problem_.views.size());
    problem_.views.push_back({model_.views[view].cam_from_map, fixed});
    views_.push_back(view);
    free_views_ += !fixed;
    if (views_.size() == 1) camera_ = model_.views[view].camera;
  }

  void add_point(int point) {
    const int index = static_cast<int>(problem_.points.size());
    problem_.points.push_back(model_.points[point].position);
    points_.push_back(point);
    for (const MapModel::Observation& o : model_.points[point].observations) {
      if (index_of_view_[o.view] == kNone) add_view(o.view, true);
      const MapModel::View& view = model_.views[o.view];
      const Keypoint& keypoint = view.features->keypoints[o.keypoint];
      const Eigen::Vector2d pixel = view.features->undistorted[o.keypoint].cast<double>();
      // Converts the observation to the pixels of the camera that all views share in the problem.
      const Eigen::Vector2d in_camera(camera_.fx * (pixel.x() - view.camera.cx) / view.camera.fx + camera_.cx,
                                      camera_.fy * (pixel.y() - view.camera.cy) / view.camera.fy + camera_.cy);
      const double sigma_px = view.pyramid.scale(keypoint.octave);
      problem_.observations.push_back(
          {index_of_view_[o.view], index, in_camera, sigma_px * camera_.fx / view.camera.fx});
    }
  }

  // Returns for each observation whether its error is below the gate, its view keeps enough of them, and its point two
  // or more.
  std::vector<char> within(double gate_chi2) {
    std::vector<char> good(problem_.observations.size());
    std::vector<int> of_view(problem_.views.size(), 0), of_point(problem_.points.size(), 0);
    for (size_t i = 0; i < good.size(); ++i) {
      good[i] = reprojection_chi2(camera_, problem_, problem_.observations[i]) <= gate_chi2;
      of_view[problem_.observations[i].view] += good[i];
    }
    is_placed_.assign(problem_.views.size(), false);
    for (size_t v = 0; v < is_placed_.size(); ++v)
      is_placed_[v] = problem_.views[v].fixed || of_view[v] >= kLeastToPlace;
    for (size_t i = 0; i < good.size(); ++i) {
      good[i] = good[i] && is_placed_[problem_.observations[i].view];
      of_point[problem_.observations[i].point] += good[i];
    }
    for (size_t i = 0; i < good.size(); ++i) good[i] = good[i] && of_point[problem_.observations[i].point] >= 2;
    return good;
  }

  // Returns the pose of a view that moves along with the placed view nearest in time, of its own stream if there is
  // one.
  SE3 carried_along(size_t view) const {
    const auto before = [this](size_t v) -> const MapModel::View& { return model_.views[views_[v]]; };
    const auto apart = [&](size_t v) {
      const ImageId &a = before(v).image, &b = before(view).image;
      return std::pair(a.stream != b.stream, std::abs(a.utime_us - b.utime_us));
    };
    std::optional<size_t> next;
    for (size_t v = 0; v < views_.size(); ++v)
      if (is_placed_[v] && (!next || apart(v) < apart(*next))) next = v;
    const SE3& was = before(view).cam_from_map;
    if (!next || problem_.views[*next].fixed) return was;
    return was * before(*next).cam_from_map.inverse() * problem_.views[*next].cam_from_submap;
  }

  void apply(double gate_chi2, MapBundleReport* report) {
    // This must come before the model changes, because it uses the poses before the adjustment.
    for (size_t v = 0; v < views_.size(); ++v)
      if (!is_placed_[v]) problem_.views[v].cam_from_submap = carried_along(v);
    for (size_t v = 0; v < views_.size(); ++v)
      if (!problem_.views[v].fixed) model_.views[views_[v]].cam_from_map = problem_.views[v].cam_from_submap;
    for (size_t p = 0; p < points_.size(); ++p) model_.points[points_[p]].position = problem_.points[p];
    double sum = 0;
    for (const BundleProblem::Observation& o : problem_.observations) {
      const double chi2 = reprojection_chi2(camera_, problem_, o);
      if (chi2 <= gate_chi2) {
        sum += chi2;
        ++report->observations;
      } else {
        model_.forget(points_[o.point], views_[o.view]);
        ++report->outliers;
      }
    }
    report->rmse = std::sqrt(sum / std::max(1, report->observations));
  }

  MapModel& model_;
  Camera camera_;
  BundleProblem problem_;
  std::vector<int> views_, points_;  // index in the model, by index in the problem
  std::vector<int> index_of_view_;
  std::vector<bool> is_placed_;  // whether the last round placed the view, by index in the problem
  size_t free_views_ = 0;
};

MapBundleReport adjust_in_pieces(const std::vector<int>& views, const MapBundleOptions& options, MapModel* model) {
  MapBundleReport sum;
  for (size_t round = 0; round < options.gates_chi2.size(); ++round) {
    MapBundleOptions one = options;
    one.gates_chi2 = {options.gates_chi2[round]};
    one.solver = nullptr;  // the solver cannot be shared, because pieces see different points
    sum = {};
    double squares = 0;
    for (const std::vector<int>& piece :
         covisible_pieces(*model, views, options.most_views, round % 2 ? options.most_views / 2 : options.most_views)) {
      if (options.cancel && *options.cancel) return sum;
      const MapBundleReport report = Bundle(piece, model).run(one);
      sum.views += report.views;
      sum.points += report.points;
      sum.observations += report.observations;
      sum.outliers += report.outliers;
      squares += report.rmse * report.rmse * report.observations;
    }
    sum.rmse = std::sqrt(squares / std::max(1, sum.observations));
  }
  return sum;
}

}  // namespace

MapBundleReport adjust_map(const std::vector<int>& views, const MapBundleOptions& options, MapModel* model) {
  if (model->views.empty()) return {};
  std::vector<int> free = views;
  if (free.empty()) {
    free.resize(model->views.size());
    std::iota(free.begin(), free.end(), 0);
  }
  if (free.size() <= static_cast<size_t>(options.most_views)) return Bundle(free, model).run(options);
  return adjust_in_pieces(free, options, model);
}

}  // namespace rumi::map_server
