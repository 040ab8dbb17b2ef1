// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/places/place_matching.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

#include "slam/features/matching.h"

namespace rumi::map_server {
namespace {

// A landmark's neighbourhood is the kNeighbours nearest ones within kAround of the image's width, at about its depth.
constexpr size_t kNeighbours = 12;
constexpr double kAround = 0.1, kDepthLog = 0.15;
constexpr int kMostFound = 1;            // a neighbourhood in which at most so many are found is silent
constexpr double kSameLookCosine = 0.9;  // of the angle between two rays to a landmark that looks the same from both

// Keeps the first match of each landmark on both sides.
std::vector<PlaceMatch> one_to_one(const std::vector<PlaceMatch>& ranked, size_t landmarks_a, size_t landmarks_b) {
  std::vector<char> taken_a(landmarks_a, 0), taken_b(landmarks_b, 0);
  std::vector<PlaceMatch> kept;
  for (const PlaceMatch& m : ranked) {
    if (taken_a[m.a] || taken_b[m.b]) continue;
    taken_a[m.a] = taken_b[m.b] = 1;
    kept.push_back(m);
  }
  return kept;
}

struct Prediction {
  Eigen::Vector2f pixel;  // undistorted pixel
  double octave = 0;
  double depth = 0;   // in the unit of `to`
  double cosine = 1;  // of the angle between the rays from the two places
};

// Projects landmarks of one place into keyframes of the other place.
class Projector {
 public:
  Projector(const PlaceNeighbourhood& from, const Submap& to, const Sim3& to_from_from,
            const PlaceMatchOptions& options)
      : from_(from),
        to_(to),
        to_from_from_(to_from_from),
        options_(options),
        log_factor_(std::log(to.pyramid.scale_factor)),
        octaves_per_octave_(std::log(from.submap->pyramid.scale_factor) / log_factor_) {}

  // Returns nullopt if the landmark is out of view, is seen from too different a direction, or would be of an octave
  // that is not detected.
  std::optional<Prediction> predict(const PlaceLandmark& landmark, const SE3& cam_from_to) const {
    const Eigen::Vector3d point = to_from_from_ * landmark.position;
    const Eigen::Vector3d in_cam = cam_from_to * point;
    if (!(in_cam.z() > 1e-9)) return std::nullopt;
    const Eigen::Vector2d pixel = to_.camera.project_undistorted(in_cam);
    if (!to_.camera.contains(pixel)) return std::nullopt;
    const PlaceSighting& seen = landmark.sightings.front();
    const SE3& cam_from_from = from_.views[seen.view].keyframe->cam_from_submap;
    const Eigen::Vector3d ray = to_from_from_.rotation * (landmark.position - cam_from_from.center());
    const Eigen::Vector3d ray_here = point - cam_from_to.center();
    if (!(ray.dot(ray_here) >= options_.min_view_cosine * ray.norm() * ray_here.norm())) return std::nullopt;
    // The landmark's size in pixels in `to`, over its size in `from`.
    const double size_ratio =
        to_from_from_.scale * ray.norm() * to_.camera.fx / (ray_here.norm() * from_.submap->camera.fx);
    const double octave = from_.octave(seen) * octaves_per_octave_ + std::log(size_ratio) / log_factor_;
    if (octave < -options_.octave_tolerance || octave > to_.pyramid.levels - 1 + options_.octave_tolerance)
      return std::nullopt;
    return Prediction{pixel.cast<float>(), octave, in_cam.z(), ray.dot(ray_here) / (ray.norm() * ray_here.norm())};
  }

  // Calls visit(keypoint, Hamming distance, most similar sighting) for each keypoint that may observe the landmark.
  template <class Visit>
  void search(const PlaceLandmark& landmark, const Prediction& at, const PlaceView& view, double radius_px,
              Visit visit) const {
    const Features& features = *view.keyframe->features;
    const double widest = radius_px * std::pow(to_.pyramid.scale_factor, at.octave + options_.octave_tolerance);
    view.grid.for_each_near(at.pixel, static_cast<float>(widest), [&](int k) {
      const int octave = features.keypoints[k].octave;
      if (std::abs(octave - at.octave) > options_.octave_tolerance) return;
      const double radius = radius_px * std::pow(to_.pyramid.scale_factor, octave);
      if ((features.undistorted[k] - at.pixel).squaredNorm() > radius * radius) return;
      int best = options_.max_distance + 1;
      PlaceSighting like;
      for (const PlaceSighting& s : landmark.sightings) {
        const int d = hamming_distance(from_.features(s.view).descriptors[s.keypoint], features.descriptors[k]);
        if (d >= best) continue;
        best = d;
        like = s;
      }
      if (best <= options_.max_distance) visit(k, best, like);
    });
  }

 private:
  const PlaceNeighbourhood& from_;
  const Submap& to_;
  const Sim3& to_from_from_;
  const PlaceMatchOptions& options_;
  const double log_factor_;          // log scale factor of the pyramid of `to`
  const double octaves_per_octave_;  // levels of the pyramid of `to` per level of the pyramid of `from`
};

struct Expected {
  Eigen::Vector2f pixel;
  double log_depth;
  bool found;
};

void count_silent(std::vector<Expected> all, float radius_px, Witness* result) {
  const auto left_of = [](const Expected& x, const Expected& y) { return x.pixel.x() < y.pixel.x(); };
  std::stable_sort(all.begin(), all.end(), left_of);
  std::vector<std::pair<float, bool>> around;  // squared distance, and whether it is found
  auto first = all.begin();
  for (const Expected& one : all) {
    while (first->pixel.x() < one.pixel.x() - radius_px) ++first;
    around.clear();
    for (auto other = first; other != all.end() && other->pixel.x() <= one.pixel.x() + radius_px; ++other) {
      const float distance = (other->pixel - one.pixel).squaredNorm();
      if (distance <= radius_px * radius_px && std::abs(other->log_depth - one.log_depth) <= kDepthLog)
        around.emplace_back(distance, other->found);
    }
    if (around.size() < kNeighbours) continue;
    const auto end = around.begin() + kNeighbours;
    std::nth_element(around.begin(), end - 1, around.end());
    ++result->telling;
    result->silent +=
        std::count_if(around.begin(), end, [](const auto& neighbour) { return neighbour.second; }) <= kMostFound;
  }
}

}  // namespace

void PlaceProposals::compare(size_t view_a, size_t view_b) {
  const PlaceView &from = a_.views[view_a], &to = b_.views[view_b];
  if (from.known.empty() || to.known.empty()) return;  // match_features() would take an empty selection for all
  for (const Match& m : match_features(*from.keyframe->features, from.known, *to.keyframe->features, to.known,
                                       {options_.max_distance, options_.max_ratio, true})) {
    const PlaceMatch match{from.landmark_index[m.first],
                           to.landmark_index[m.second],
                           {static_cast<int>(view_a), m.first},
                           {static_cast<int>(view_b), m.second},
                           m.distance};
    Votes& v = votes_[{match.a, match.b}];
    if (v.count++ == 0 || match.distance < v.best.distance) v.best = match;
  }
}

std::vector<PlaceMatch> PlaceProposals::ranked() const {
  std::vector<Votes> ranked;
  ranked.reserve(votes_.size());
  for (const auto& [pair, v] : votes_) ranked.push_back(v);
  std::stable_sort(ranked.begin(), ranked.end(), [](const Votes& x, const Votes& y) {
    return std::tuple(-x.count, x.best.distance) < std::tuple(-y.count, y.best.distance);
  });
  std::vector<PlaceMatch> matches;
  matches.reserve(ranked.size());
  for (const Votes& v : ranked) matches.push_back(v.best);
  return one_to_one(matches, a_.landmarks.size(), b_.landmarks.size());
}

std::vector<PlaceMatch> guided_matches(const PlaceNeighbourhood& a, const PlaceNeighbourhood& b, const Sim3& b_from_a,
                                       double radius_px, const PlaceMatchOptions& options) {
  const Projector projector(a, *b.submap, b_from_a, options);
  const Sim3 a_from_b = b_from_a.inverse();
  const auto returns = [&](int landmark_b, const PlaceSighting& in_a) {
    const Eigen::Vector3d in_cam =
        a.views[in_a.view].keyframe->cam_from_submap * (a_from_b * b.landmarks[landmark_b].position);
    if (!(in_cam.z() > 1e-9)) return false;
    const double radius = radius_px * std::pow(a.submap->pyramid.scale_factor, a.octave(in_a));
    return (a.submap->camera.project_undistorted(in_cam) - a.pixel(in_a)).norm() <= radius;
  };
  std::vector<PlaceMatch> found;
  for (size_t j = 0; j < b.views.size(); ++j) {
    const PlaceView& view = b.views[j];
    for (size_t l = 0; l < a.landmarks.size(); ++l) {
      const auto at = projector.predict(a.landmarks[l], view.keyframe->cam_from_submap);
      if (!at) continue;
      PlaceMatch best;
      best.distance = options.max_distance + 1;
      projector.search(a.landmarks[l], *at, view, radius_px, [&](int k, int distance, const PlaceSighting& like) {
        if (view.landmark_index[k] == kNone || distance >= best.distance) return;
        best = {static_cast<int>(l), view.landmark_index[k], like, {static_cast<int>(j), k}, distance};
      });
      if (best.a != kNone && returns(best.b, best.in_a)) found.push_back(best);
    }
  }
  std::stable_sort(found.begin(), found.end(), [](const PlaceMatch& x, const PlaceMatch& y) {
    return std::tuple(x.distance, x.a, x.b) < std::tuple(y.distance, y.a, y.b);
  });
  return one_to_one(found, a.landmarks.size(), b.landmarks.size());
}

Witness hear_witness(const PlaceNeighbourhood& from, const Submap& to, const PlaceView& witness,
                     const Sim3& to_from_from, double radius_px, const PlaceMatchOptions& options) {
  const Projector projector(from, to, to_from_from, options);
  Witness result;
  std::vector<Expected> telling;
  for (const PlaceLandmark& landmark : from.landmarks) {
    const auto at = projector.predict(landmark, witness.keyframe->cam_from_submap);
    if (!at) continue;
    ++result.visible;
    bool found = false;
    projector.search(landmark, *at, witness, radius_px, [&](int, int, const PlaceSighting&) { found = true; });
    result.found += found;
    if (at->cosine >= kSameLookCosine && at->octave >= 0 && at->octave <= to.pyramid.levels - 1)
      telling.push_back({at->pixel, std::log(at->depth), found});
  }
  count_silent(std::move(telling), static_cast<float>(kAround * to.camera.width), &result);
  return result;
}

}  // namespace rumi::map_server
