// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/model/scale_check.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>
#include <span>

#include "slam/numeric/median.h"

namespace rumi::ruminator {

namespace {

constexpr double kMinParallaxDeg = 0.5;  // least parallax of a point on each side of a cut
// At least kMinPoints points across a cut determine the ratio of the scales if the standard error of its logarithm is
// at most kMaxLogError. kFewPoints suffice if all of them agree closely, which wrong points do not.
constexpr int kMinPoints = 5;
constexpr double kMaxLogError = 0.2;
constexpr int kFewPoints = 3;
constexpr double kFewMaxLogSpread = 0.1;
// At least this many points with at most this error determine the scale better than front_tracker's poses do.
constexpr int kCertainPoints = 30;
constexpr double kCertainLogError = 0.05;
constexpr int kMinDepthPoints = 20;  // least number of points that one side must triangulate by itself to have a scale

// Computes the median of the logarithms and its standard error (from the median absolute deviation). Destroys `logs`.
void summarize(std::vector<double>* logs, ScaleCut* cut) {
  cut->points = static_cast<int>(logs->size());
  if (logs->empty()) return;
  const RobustMean ratio = robust_mean(logs, static_cast<double>(logs->size()));
  cut->log_ratio = ratio.value;
  cut->log_error = ratio.sigma;
  cut->log_spread = *std::max_element(logs->begin(), logs->end());
}

// True if the points across the cut determine the ratio of the scales of the two sides.
bool is_carried(const ScaleCut& cut) {
  return (cut.points >= kMinPoints && cut.log_error <= kMaxLogError) ||
         (cut.points >= kFewPoints && cut.log_spread <= kFewMaxLogSpread);
}

// Counts the points for which the images on one side of the cut have enough parallax. Stops at kMinDepthPoints.
int points_with_depth(const SparseModel& model, int last_before, bool before) {
  int count = 0;
  for (const SparseModel::Point& point : model.points) {
    SparseModel::Point part{point.position, {}};
    for (const auto& o : point.track)
      if ((o.first <= last_before) == before) part.track.push_back(o);
    if ((count += has_parallax(model, part, kMinParallaxDeg)) >= kMinDepthPoints) return count;
  }
  return count;
}

// Returns a cut after each registered image except the last.
std::vector<ScaleCut> cuts_of(const SparseModel& model) {
  std::vector<ScaleCut> cuts;
  for (const auto& [image, pose] : model.cam_from_world) cuts.push_back({.image = image});
  if (!cuts.empty()) cuts.pop_back();
  return cuts;
}

// Returns the cuts from the one after image `before` to the last one before image `after`.
std::span<ScaleCut> cuts_between(int before, int after, std::vector<ScaleCut>* cuts) {
  const auto is_before = [](const ScaleCut& cut, int image) { return cut.image < image; };
  const auto first = std::lower_bound(cuts->begin(), cuts->end(), before, is_before);
  return {first, std::lower_bound(first, cuts->end(), after, is_before)};
}

}  // namespace

std::vector<ScaleCut> check_scale(const Camera& camera, const std::vector<WindowImage>& images,
                                  const std::vector<Track>& tracks, const SparseModel& model) {
  ModelRefinementOptions triangulation;
  triangulation.min_parallax_deg = kMinParallaxDeg;
  const auto see = [&](const Track& part) -> std::optional<Eigen::Vector3d> {
    if (part.size() < 2) return std::nullopt;
    const auto point = triangulate_track(camera, images, part, triangulation, model);
    if (!point || point->track.size() < part.size()) return std::nullopt;
    return point->position;
  };
  std::vector<ScaleCut> cuts = cuts_of(model);
  std::map<int, std::vector<double>> logs;  // by the image of the cut
  for (const Track& track : tracks) {
    Track posed;
    std::copy_if(track.begin(), track.end(), std::back_inserter(posed),
                 [&model](const auto& o) { return model.cam_from_world.contains(o.first); });
    for (size_t i = 1; i < posed.size(); ++i) {
      const auto middle = posed.begin() + static_cast<std::ptrdiff_t>(i);
      const auto seen_before = see({posed.begin(), middle});
      const auto seen_after = seen_before ? see({middle, posed.end()}) : std::nullopt;
      // All cuts between two successive images of the track divide it alike.
      for (ScaleCut& cut : cuts_between(posed[i - 1].first, posed[i].first, &cuts)) {
        ++cut.tracks;
        if (!seen_after) continue;
        const Eigen::Vector3d center = model.cam_from_world.at(cut.image).center();
        const double log = std::log((*seen_after - center).norm() / (*seen_before - center).norm());
        if (std::isfinite(log)) logs[cut.image].push_back(log);
      }
    }
  }
  for (ScaleCut& cut : cuts) {
    summarize(&logs[cut.image], &cut);
    cut.is_break = !is_carried(cut) && points_with_depth(model, cut.image, true) >= kMinDepthPoints &&
                   points_with_depth(model, cut.image, false) >= kMinDepthPoints;
  }
  return cuts;
}

bool is_certain(const ScaleCut& cut) { return cut.points >= kCertainPoints && cut.log_error <= kCertainLogError; }

std::optional<ScaleCut> find_slip(const std::vector<ScaleCut>& cuts, double max_change) {
  std::optional<ScaleCut> worst;
  for (const ScaleCut& cut : cuts) {
    const bool is_told =
        cut.points >= kMinPoints && cut.log_error < kMaxLogError && std::abs(cut.log_ratio) > 3 * cut.log_error;
    if (!is_told || std::abs(cut.log_ratio) < std::log1p(max_change)) continue;
    if (!worst || std::abs(cut.log_ratio) > std::abs(worst->log_ratio)) worst = cut;
  }
  return worst;
}

std::optional<ScaleCut> find_break(const std::vector<ScaleCut>& cuts) {
  std::optional<ScaleCut> weakest;
  for (const ScaleCut& cut : cuts)
    if (cut.is_break && (!weakest || std::pair(cut.points, cut.tracks) < std::pair(weakest->points, weakest->tracks)))
      weakest = cut;
  return weakest;
}

int keep_larger_side(const ScaleCut& cut, SparseModel* model) {
  std::set<int> before, after;
  for (const auto& [image, pose] : model->cam_from_world) (image <= cut.image ? before : after).insert(image);
  const std::set<int>& smaller = before.size() >= after.size() ? after : before;
  remove_images(smaller, model);
  return static_cast<int>(smaller.size());
}

void repair_scale(const ScaleCut& cut, SparseModel* model) {
  const Eigen::Vector3d center = model->cam_from_world.at(cut.image).center();
  for (auto& [image, pose] : model->cam_from_world) {
    if (image <= cut.image) continue;
    const Eigen::Vector3d moved = center + (pose.center() - center) * std::exp(-cut.log_ratio);
    pose.translation = -(pose.rotation * moved);
  }
}

}  // namespace rumi::ruminator
