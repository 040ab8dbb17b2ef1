// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/model/map_model.h"

#include <algorithm>
#include <numeric>
#include <optional>

#include "map_server/alignment/correspondences.h"
#include "slam/features/keypoint_grid.h"
#include "slam/numeric/median.h"
#include "slam/numeric/union_find.h"

namespace rumi::map_server {
namespace {

constexpr size_t kMinScaleLandmarks = 5;

// Returns for each keypoint of `from` the keypoint of `to` (features of the same image) at the same place; kNone if
// there is none. If both have the same keypoints, each is matched with the one of its own index, because a detector may
// find one pixel in two octaves.
std::vector<int> same_keypoints(const Features& from, const Features& to, const Camera& camera, float same_px) {
  std::vector<int> same(from.size(), kNone);
  if (same_corners(from, to)) {
    std::iota(same.begin(), same.end(), 0);
    return same;
  }
  const KeypointGrid grid(to.undistorted, camera);
  for (size_t i = 0; i < from.size(); ++i) {
    if (i < to.size() && to.undistorted[i] == from.undistorted[i]) {
      same[i] = static_cast<int>(i);
      continue;
    }
    float best = same_px;
    grid.for_each_near(from.undistorted[i], same_px, [&](int j) {
      const float distance = (to.undistorted[j] - from.undistorted[i]).norm();
      if (distance > best || (same[i] != kNone && distance == best)) return;
      best = distance;
      same[i] = j;
    });
  }
  return same;
}

class Joiner {
 public:
  Joiner(const std::map<SubmapKey, PlacedSubmap>& submaps, float same_px) : submaps_(submaps), same_px_(same_px) {}

  MapModel run() {
    make_views();
    for (const auto& [key, placed] : submaps_)
      for (const auto& [id, landmark] : placed.submap->landmarks) collect(key, landmark);
    for (const auto& [key, placed] : submaps_)
      for (const auto& [from, into] : placed.placement.fused)
        if (index_.contains({key, from}) && index_.contains(into)) same_.unite(index_.at({key, from}), index_.at(into));
    make_points();
    return std::move(model_);
  }

 private:
  struct Seen {
    int view = 0;
    std::vector<int> keypoints;  // index in the view's features, by index in the keyframe's; empty: the same
  };
  struct Item {
    LandmarkRef ref;
    std::vector<MapModel::Observation> observations;
  };

  void make_views() {
    std::map<ImageId, std::vector<KeyframeRef>> images;
    for (const auto& [key, placed] : submaps_)  // back submaps have the lower keys
      for (const auto& [id, keyframe] : placed.submap->keyframes)
        images[placed.submap->image(keyframe)].push_back({key, id});
    for (auto& [image, keyframes] : images) {
      const int index = static_cast<int>(model_.views.size());
      MapModel::View& view = model_.views.emplace_back();
      const auto fixed = std::find_if(keyframes.begin(), keyframes.end(),
                                      [this](const KeyframeRef& ref) { return submaps_.at(ref.submap).fixed; });
      view.fixed = fixed != keyframes.end();
      const KeyframeRef& best = view.fixed ? *fixed : keyframes.front();
      const PlacedSubmap& first = submaps_.at(best.submap);
      const Keyframe& chosen = *first.submap->keyframe(best.id);
      view.image = image;
      view.cam_from_map = first.placement.cam_from_map(chosen);
      view.camera = first.submap->camera;
      view.pyramid = first.submap->pyramid;
      view.features = chosen.features;
      for (const KeyframeRef& ref : keyframes) {
        const auto& features = submaps_.at(ref.submap).submap->keyframe(ref.id)->features;
        if (ref.submap.id > 0 && same_corners(*features, *chosen.features)) view.features = features;
      }
      view.points.assign(chosen.features->size(), kNone);
      view.keyframes = std::move(keyframes);
      first_seen_.emplace_back(chosen.features->size(), kNone);
      for (const KeyframeRef& ref : view.keyframes) seen_[{ref.submap, ref.id}] = see(ref, view, index);
    }
  }

  Seen see(const KeyframeRef& ref, const MapModel::View& view, int index) const {
    const auto& own = submaps_.at(ref.submap).submap->keyframe(ref.id)->features;
    Seen seen{index, {}};
    if (own != view.features) seen.keypoints = same_keypoints(*own, *view.features, view.camera, same_px_);
    return seen;
  }

  void collect(SubmapKey key, const Landmark& landmark) {
    const size_t item = items_.size();
    items_.push_back({{key, landmark.id}, {}});
    same_.add();
    index_[items_.back().ref] = item;
    for (const Observation& o : landmark.observations) {
      const Seen& seen = seen_.at({key, o.keyframe_id});
      const int keypoint = seen.keypoints.empty() ? o.keypoint_index : seen.keypoints[o.keypoint_index];
      if (keypoint == kNone) continue;
      items_.back().observations.push_back({seen.view, keypoint});
      int& first = first_seen_[seen.view][keypoint];
      if (first == kNone)
        first = static_cast<int>(item);
      else
        same_.unite(static_cast<size_t>(first), item);
    }
  }

  void make_points() {
    std::vector<int> point_of(items_.size(), kNone);
    for (size_t i = 0; i < items_.size(); ++i) {
      int& point = point_of[same_.find(i)];
      if (point == kNone) {  // item i represents all items that are the same point
        const PlacedSubmap& placed = submaps_.at(items_[i].ref.submap);
        const Landmark& landmark = *placed.submap->landmark(items_[i].ref.id);
        point = static_cast<int>(model_.points.size());
        model_.points.push_back(
            {placed.placement.position_in_map(*placed.submap, landmark), landmark.descriptor, {}, {}});
      }
      model_.points[point].landmarks.push_back(items_[i].ref);
      for (const MapModel::Observation& o : items_[i].observations) model_.observe(point, o.view, o.keypoint);
    }
  }

  const std::map<SubmapKey, PlacedSubmap>& submaps_;
  float same_px_;
  MapModel model_;
  std::map<std::pair<SubmapKey, int>, Seen> seen_;  // the view of each keyframe
  std::vector<std::vector<int>> first_seen_;        // by view and keypoint: the first item seen there
  std::vector<Item> items_;                         // landmarks, those of back submaps first
  UnionFind same_;                                  // groups of items that are one point
  std::map<LandmarkRef, size_t> index_;
};

double scale_at(const MapModel& model, const MapModel::View& view, const std::map<int, int>& point_of,
                const Submap& submap, const Keyframe& keyframe, double otherwise) {
  std::vector<double> ratios;
  for (int id : keyframe.landmark_ids) {
    const auto point = point_of.find(id);
    if (id == kNone || point == point_of.end()) continue;
    const double raw = (keyframe.cam_from_submap * submap.landmark(id)->position).z();
    const double placed = (view.cam_from_map * model.points[point->second].position).z();
    if (raw > 0 && placed > 0) ratios.push_back(placed / raw);
  }
  return ratios.size() < kMinScaleLandmarks ? otherwise : median(&ratios);
}

// Returns the landmark into which the point's other landmarks are fused: one of a fixed submap, if there is one. If
// that landmark is itself fused into one outside the model, returns the one outside.
LandmarkRef stands_for(const std::vector<LandmarkRef>& landmarks, const std::map<SubmapKey, PlacedSubmap>& submaps) {
  std::optional<LandmarkRef> outside;
  for (const LandmarkRef& ref : landmarks) {
    const PlacedSubmap& owner = submaps.at(ref.submap);
    if (!owner.fixed) continue;
    const auto fused = owner.placement.fused.find(ref.id);
    if (fused == owner.placement.fused.end()) return ref;
    if (!submaps.contains(fused->second.submap)) outside = fused->second;
  }
  return outside.value_or(landmarks.back());
}

}  // namespace

bool MapModel::observe(int point, int view, int keypoint) {
  std::vector<Observation>& observations = points[point].observations;
  if (views[view].points[keypoint] != kNone) return false;
  if (std::any_of(observations.begin(), observations.end(), [&](const auto& o) { return o.view == view; }))
    return false;
  observations.push_back({view, keypoint});
  views[view].points[keypoint] = point;
  return true;
}

void MapModel::forget(int point, int view) {
  std::erase_if(points[point].observations, [&](const Observation& o) {
    if (o.view != view) return false;
    views[view].points[o.keypoint] = kNone;
    return true;
  });
}

void MapModel::fuse(int into, int from) {
  const std::vector<Observation> observations = std::move(points[from].observations);
  points[from].observations.clear();
  for (const Observation& o : observations) {
    views[o.view].points[o.keypoint] = kNone;
    observe(into, o.view, o.keypoint);
  }
  auto& landmarks = points[into].landmarks;
  landmarks.insert(landmarks.end(), points[from].landmarks.begin(), points[from].landmarks.end());
  points[from].landmarks.clear();
}

MapModel join(const std::map<SubmapKey, PlacedSubmap>& submaps, double same_px) {
  return Joiner(submaps, static_cast<float>(same_px)).run();
}

void forget_removed(const std::map<SubmapKey, PlacedSubmap>& submaps, MapModel* model) {
  for (MapModel::View& view : model->views)
    std::erase_if(view.keyframes,
                  [&](const KeyframeRef& ref) { return !submaps.at(ref.submap).submap->keyframe(ref.id); });
  for (MapModel::Point& point : model->points)
    std::erase_if(point.landmarks,
                  [&](const LandmarkRef& ref) { return !submaps.at(ref.submap).submap->landmark(ref.id); });
}

std::map<SubmapKey, Placement> split(const MapModel& model, const std::map<SubmapKey, PlacedSubmap>& submaps) {
  std::map<SubmapKey, Placement> placements;
  std::map<SubmapKey, std::map<int, int>> point_of;
  for (const auto& [key, placed] : submaps) placements[key];
  for (size_t p = 0; p < model.points.size(); ++p) {
    // A point that is not placed gives its landmarks no position: they follow their keyframes.
    if (model.points[p].observations.size() < 2 || !model.points[p].position.allFinite()) continue;
    const std::vector<LandmarkRef>& landmarks = model.points[p].landmarks;
    if (landmarks.empty()) continue;  // all its landmarks were culled
    const LandmarkRef into = stands_for(landmarks, submaps);
    for (const LandmarkRef& ref : landmarks) {
      point_of[ref.submap][ref.id] = static_cast<int>(p);
      placements[ref.submap].landmarks[ref.id] = model.points[p].position;
      if (ref != into) placements[ref.submap].fused[ref.id] = into;
    }
  }
  for (const MapModel::View& view : model.views)
    for (const KeyframeRef& ref : view.keyframes) {
      const PlacedSubmap& before = submaps.at(ref.submap);
      const Keyframe& keyframe = *before.submap->keyframe(ref.id);
      const double scale = scale_at(model, view, point_of[ref.submap], *before.submap, keyframe,
                                    before.placement.at(view.image.utime_us).scale);
      const Sim3 map_from_submap = similarity_through(keyframe.cam_from_submap, view.cam_from_map, scale);
      if (map_from_submap.is_finite()) placements[ref.submap].map_from_submap[view.image.utime_us] = map_from_submap;
    }
  for (const auto& [key, placed] : submaps)
    if (placed.fixed) placements[key] = placed.placement;
  return placements;
}

}  // namespace rumi::map_server
