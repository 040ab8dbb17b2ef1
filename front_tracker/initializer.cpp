// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/initializer.h"

#include <fmt/core.h>

#include <algorithm>

#include "slam/features/matching.h"
#include "slam/geometry/median.h"
#include "slam/geometry/resection.h"
#include "slam/geometry/triangulation.h"
#include "slam/geometry/two_view.h"
#include "slam/optimization/bundle_adjustment.h"

namespace rumi {
namespace {

constexpr size_t kMostBetween =
    10;  // frames between the two that are asked whether they agree; all would take a second

}  // namespace

// Views with poses and the points they see, while it is being worked out. Views and points are those of the bundle
// problem.
struct Initializer::Structure {
  std::vector<size_t> frame_of_view;        // index into frames_
  std::vector<int> reference_keypoint;      // of each point
  std::vector<std::vector<int>> keypoints;  // per view, per point: the keypoint or kNone
  BundleProblem bundle;                     // observations are filled by adjust()
  double rmse_px = 0;                       // after adjust()
  size_t tried_between = 0;                 // frames between the two that were asked
};

Initializer::Initializer(const Camera& camera, const InitializerOptions& options, const std::vector<double>& scales)
    : camera_(camera), options_(options), scales_(scales) {
  options_.two_view.min_median_parallax_deg = options.min_parallax_deg;
}

void Initializer::clear() {
  frames_.clear();
  reference_ = 0;
  refusal_.clear();
}

void Initializer::trim() {
  while (static_cast<int>(frames_.size()) > options_.max_frames) {
    frames_.pop_front();
    reference_ = reference_ > 0 ? reference_ - 1 : 0;
  }
}

void Initializer::buffer(Frame frame) {
  frames_.push_back(std::move(frame));
  trim();
}

std::vector<std::pair<int, int>> Initializer::match_with_reference(const Frame& frame) {
  MatchOptions match;
  match.max_shift_px = options_.max_shift * camera_.width;
  while (reference_ + 1 < frames_.size()) {
    const std::vector<Match> matches = match_features(*frames_[reference_].features, {}, *frame.features, {}, match);
    if (static_cast<int>(matches.size()) >= options_.min_matches) {
      std::vector<std::pair<int, int>> pairs;
      pairs.reserve(matches.size());
      for (const Match& m : matches) pairs.emplace_back(m.first, m.second);
      return pairs;
    }
    // Too little in common: the reference moves half way towards the present.
    reference_ += std::max<size_t>(1, (frames_.size() - 1 - reference_) / 2);
  }
  refusal_ = "too few matches with any frame before";
  return {};
}

std::optional<InitialMap> Initializer::add(Frame frame) {
  buffer(std::move(frame));
  const std::vector<std::pair<int, int>> matches = match_with_reference(frames_.back());
  if (matches.empty()) return std::nullopt;
  std::vector<Structure> structures = reconstruct(matches);
  std::erase_if(structures, [this](Structure& s) {
    add_views_between(&s);
    return !adjust(&s);
  });
  if (structures.empty()) return std::nullopt;
  std::stable_sort(structures.begin(), structures.end(),
                   [](const Structure& a, const Structure& b) { return a.rmse_px < b.rmse_px; });
  if (structures.size() > 1 && structures[0].rmse_px > options_.max_rival_rmse_ratio * structures[1].rmse_px) {
    refusal_ = fmt::format("ambiguous: two structures with errors of {:.2f} and {:.2f} px", structures[0].rmse_px,
                           structures[1].rmse_px);
    return std::nullopt;
  }
  return finish(std::move(structures.front()));
}

// One structure per hypothesis of the two-view problem.
std::vector<Initializer::Structure> Initializer::reconstruct(const std::vector<std::pair<int, int>>& matches) {
  const Features &first = *frames_[reference_].features, &last = *frames_.back().features;
  std::vector<Eigen::Vector2f> a, b;
  for (const auto& [i, j] : matches) {
    a.push_back(first.undistorted[i]);
    b.push_back(last.undistorted[j]);
  }
  const TwoViewResult pair = reconstruct_two_views(camera_, a, b, options_.two_view);
  refusal_ = pair.refusal;
  if (!pair.ok()) return {};
  const double parallax_deg = pair.hypotheses.front().median_parallax_deg;
  if (parallax_deg<options_.accept_parallax_deg&& static_cast<int>(matches.size())> 2 * options_.min_matches) {
    refusal_ = fmt::format("parallax {:.2f} deg: waiting for more", parallax_deg);
    return {};
  }
  std::vector<Structure> structures;
  for (const TwoViewHypothesis& h : pair.hypotheses) {
    Structure s;
    s.frame_of_view = {reference_, frames_.size() - 1};
    s.bundle.views = {{SE3(), true}, {h.second_from_first, false}};
    s.keypoints.resize(2);
    for (size_t k = 0; k < matches.size(); ++k) {
      if (!h.points[k]) continue;
      s.bundle.points.push_back(*h.points[k]);
      s.reference_keypoint.push_back(matches[k].first);
      s.keypoints[0].push_back(matches[k].first);
      s.keypoints[1].push_back(matches[k].second);
    }
    structures.push_back(std::move(s));
  }
  return structures;
}

// Frames between the two are a check that costs nothing: a structure that they do not agree with is wrong.
void Initializer::add_views_between(Structure* s) const {
  MatchOptions match;
  match.max_shift_px = options_.max_shift * camera_.width;
  const Features& reference = *frames_[reference_].features;
  std::vector<int> point_of(reference.size(), kNone);
  for (size_t p = 0; p < s->reference_keypoint.size(); ++p) point_of[s->reference_keypoint[p]] = static_cast<int>(p);
  const size_t step = std::max<size_t>(1, (frames_.size() - reference_) / kMostBetween);
  for (size_t f = reference_ + step; f + 1 < frames_.size(); f += step) {
    ++s->tried_between;
    std::vector<int> keypoints(s->bundle.points.size(), kNone);
    std::vector<PointObservation> observations;
    std::vector<int> point;
    for (const Match& m : match_features(reference, s->reference_keypoint, *frames_[f].features, {}, match)) {
      const int p = point_of[m.first];
      keypoints[p] = m.second;
      const Keypoint& k = frames_[f].features->keypoints[m.second];
      observations.push_back(
          {s->bundle.points[p], frames_[f].features->undistorted[m.second].cast<double>(), scales_[k.octave]});
      point.push_back(p);
    }
    const auto pose = resect(camera_, observations, {options_.two_view.min_points / 2, 4.0, 200});
    if (!pose || pose->inliers < 0.5 * observations.size()) continue;
    for (size_t i = 0; i < point.size(); ++i)
      if (!pose->inlier[i]) keypoints[point[i]] = kNone;
    s->frame_of_view.push_back(f);
    s->bundle.views.push_back({pose->cam_from_submap, false});
    s->keypoints.push_back(std::move(keypoints));
  }
}

bool Initializer::adjust(Structure* s) {
  const size_t found = s->bundle.views.size() - 2;
  if (2 * found < s->tried_between) {
    refusal_ = fmt::format("only {} of {} frames between agree", found, s->tried_between);
    return false;
  }
  BundleProblem& bundle = s->bundle;
  const auto fill = [&](bool inliers_only) {
    std::vector<BundleProblem::Observation> kept;
    for (size_t v = 0; v < bundle.views.size(); ++v) {
      const Features& features = *frames_[s->frame_of_view[v]].features;
      for (size_t p = 0; p < bundle.points.size(); ++p) {
        int& keypoint = s->keypoints[v][p];
        if (keypoint == kNone) continue;
        const BundleProblem::Observation o{static_cast<int>(v), static_cast<int>(p),
                                           features.undistorted[keypoint].cast<double>(),
                                           scales_[features.keypoints[keypoint].octave]};
        if (inliers_only && reprojection_chi2(camera_, bundle, o) > 5.991)
          keypoint = kNone;
        else
          kept.push_back(o);
      }
    }
    bundle.observations = std::move(kept);
  };
  fill(false);
  if (!solve_bundle(camera_, {15}, &bundle).usable) {
    refusal_ = "the first bundle adjustment failed";
    return false;
  }
  fill(true);
  solve_bundle(camera_, {15}, &bundle);
  fill(true);

  double sum = 0;
  for (const auto& o : bundle.observations) sum += reprojection_chi2(camera_, bundle, o);
  s->rmse_px = std::sqrt(sum / static_cast<double>(std::max<size_t>(1, bundle.observations.size())));
  std::vector<double> parallaxes;
  for (size_t p = 0; p < bundle.points.size(); ++p)
    if (s->keypoints[0][p] != kNone && s->keypoints[1][p] != kNone)
      parallaxes.push_back(parallax_rad(bundle.points[p], bundle.views[0].cam_from_submap.center(),
                                        bundle.views[1].cam_from_submap.center()));
  if (static_cast<int>(parallaxes.size()) < options_.two_view.min_points) {
    refusal_ = fmt::format("{} points left after bundle adjustment", parallaxes.size());
    return false;
  }
  const double parallax = median(&parallaxes) * 180 / M_PI;
  if (s->rmse_px > options_.max_rmse_px || parallax < options_.min_parallax_deg) {
    refusal_ = fmt::format("after bundle adjustment: error {:.2f} px, parallax {:.2f} deg", s->rmse_px, parallax);
    return false;
  }
  return true;
}

InitialMap Initializer::finish(Structure s) {
  std::vector<double> depths;
  for (const auto& p : s.bundle.points) depths.push_back(p.z());
  const Sim3 unit_from_reference(1.0 / median(&depths), Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero());

  InitialMap map;
  // The two ends and an even choice of what lies between become keyframes; the other views only lend their poses.
  const size_t between = s.bundle.views.size() - 2;
  const size_t wanted = std::min<size_t>(between, std::max(0, options_.max_keyframes - 2));
  for (size_t v = 0; v < s.bundle.views.size(); ++v) {
    const size_t i = v - 2;
    const bool keyframe = v < 2 || (i * wanted / between != (i + 1) * wanted / between);
    map.views.push_back(
        {s.frame_of_view[v], unit_from_reference.transform_camera(s.bundle.views[v].cam_from_submap), keyframe});
  }
  for (size_t p = 0; p < s.bundle.points.size(); ++p) {
    InitialMap::Point point{unit_from_reference * s.bundle.points[p], {}};
    for (size_t v = 0; v < map.views.size(); ++v)
      if (map.views[v].keyframe && s.keypoints[v][p] != kNone) point.observations.emplace_back(v, s.keypoints[v][p]);
    if (point.observations.size() >= 2) map.points.push_back(std::move(point));
  }
  map.frames.assign(std::make_move_iterator(frames_.begin()), std::make_move_iterator(frames_.end()));
  clear();
  return map;
}

}  // namespace rumi
