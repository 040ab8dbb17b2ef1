// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/merging/map_builder.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "base/running/stage_clock.h"
#include "map_server/merging/map_members.h"

namespace rumi::map_server {
namespace {

// Moves the whole map so that the first keyframe of the anchor lies where it did before the adjustment, which may have
// changed the unit and the pose of the map.
void keep_gauge(const PlacedSubmap& anchor_before, SubmapKey anchor, Placements* placements) {
  const std::map<int64_t, Sim3>& after = placements->at(anchor).map_from_submap;
  if (after.empty()) return;
  const int64_t first_us = after.begin()->first;
  const Sim3 before_from_after = anchor_before.placement.at(first_us) * placements->at(anchor).at(first_us).inverse();
  for (auto& [key, placement] : *placements) {
    for (auto& [utime_us, map_from_submap] : placement.map_from_submap)
      map_from_submap = before_from_after * map_from_submap;
    for (auto& [id, position] : placement.landmarks) position = before_from_after * position;
  }
}

// Fuses the landmarks that an edge by appearance has matched.
void fuse_places(const LinkGraph& graph, PlacedSubmaps* submaps) {
  for (const LinkEdge* edge : graph.edges()) {
    const auto a = submaps->find(edge->link.a);
    if (a == submaps->end() || !submaps->contains(edge->link.b)) continue;
    for (const LandmarkPair& pair : edge->landmarks)
      a->second.placement.fused.try_emplace(pair.a, LandmarkRef{edge->link.b, pair.b});
  }
}

bool is_up_to_date(const std::set<SubmapKey>& members, const BuildInput& input, const LinkGraph& graph) {
  return members == input.fixed || (input.scope == BuildScope::kWeld && members == graph.built.submaps);
}

// Returns the pairs of images that have at least `points` points in common, ascending.
std::vector<std::pair<ImageId, ImageId>> similar_images(const MapModel& model, int points) {
  std::vector<std::pair<ImageId, ImageId>> similar;
  std::vector<int> shared(model.views.size(), 0), met;  // points in common with view v; the views that have any
  for (size_t v = 0; v < model.views.size(); ++v) {
    for (int point : model.views[v].points)
      if (point != kNone)
        for (const MapModel::Observation& o : model.points[point].observations)
          if (o.view < static_cast<int>(v) && shared[o.view]++ == 0) met.push_back(o.view);
    for (int other : met)
      if (std::exchange(shared[other], 0) >= points)
        similar.emplace_back(std::minmax(model.views[other].image, model.views[v].image));
    met.clear();
  }
  std::sort(similar.begin(), similar.end());
  return similar;
}

// Returns the contacts in the built map. If only a part of it was built, the earlier contacts are kept.
BuiltContacts contacts_of(const MapModel& model, const Arrangement& arranged, int points, const BuiltContacts& before) {
  const bool is_whole = arranged.part.submaps == arranged.members;
  BuiltContacts contacts{.submaps = arranged.members, .touching = {}, .similar = similar_images(model, points)};
  if (!is_whole) {
    const auto of_part = std::exchange(contacts.similar, {});
    contacts.touching = before.touching;
    std::set_union(before.similar.begin(), before.similar.end(), of_part.begin(), of_part.end(),
                   std::back_inserter(contacts.similar));
  }
  for (const MapModel::Point& point : model.points)
    for (size_t i = 0; i < point.landmarks.size(); ++i)
      for (size_t j = 0; j < i; ++j)
        if (point.landmarks[i].submap != point.landmarks[j].submap)
          contacts.touching.insert(std::minmax(point.landmarks[i].submap, point.landmarks[j].submap));
  return contacts;
}

}  // namespace

BuiltMap MapBuilder::build(LinkGraph graph, const BuildInput& input) const {
  const StageClock clock("map_server.place");
  BuiltMap built{.graph = std::move(graph)};
  const std::set<SubmapKey> members = choose_members(built.graph, input);
  built.report.members = static_cast<int>(members.size());
  if (members.empty() || input.is_cancelled() || is_up_to_date(members, input, built.graph)) return built;
  std::optional<Arrangement> arranged = arrange(members, input, options_.arrangement, &built.graph);
  if (!arranged) return built;
  AdjustedMap map{.submaps = std::move(arranged->submaps)};
  fuse_places(built.graph, &map.submaps);
  map.model = join(map.submaps, kSameKeypointPx);
  built.report = adjust(input, built.graph.built, &map.model);
  built.report.members = static_cast<int>(arranged->members.size());
  if (input.is_cancelled()) return built;
  built.graph.built = contacts_of(map.model, *arranged, options_.joined_points, built.graph.built);
  map.placements = split(map.model, map.submaps);
  if (input.scope != BuildScope::kWeld)
    built.culled = MapCulling(options_.culling, options_.links.pairs).cull(input, &built.graph, &map);
  if (input.fixed.empty() && arranged->part.fixed.empty())
    keep_gauge(map.submaps.at(arranged->anchor), arranged->anchor, &map.placements);
  built.placements = std::move(map.placements);
  const std::set<SubmapKey>& part = arranged->part.submaps;
  std::set_difference(arranged->members.begin(), arranged->members.end(), part.begin(), part.end(),
                      std::inserter(built.unmoved, built.unmoved.end()));
  return built;
}

// Returns the views of new submaps, and the other views that share most points with them.
std::vector<int> MapBuilder::weld_window(const BuiltContacts& before, const MapModel& model) const {
  std::vector<int> window;
  std::map<int, int> shared;
  for (size_t v = 0; v < model.views.size(); ++v) {
    const auto is_new = [&](const KeyframeRef& ref) { return !before.submaps.contains(ref.submap); };
    if (std::none_of(model.views[v].keyframes.begin(), model.views[v].keyframes.end(), is_new)) continue;
    window.push_back(static_cast<int>(v));
    for (int point : model.views[v].points)
      if (point != kNone)
        for (const MapModel::Observation& o : model.points[point].observations) ++shared[o.view];
  }
  for (int view : window) shared.erase(view);
  std::vector<std::pair<int, int>> neighbours;  // minus the points in common, view
  neighbours.reserve(shared.size());
  for (const auto& [view, points] : shared) neighbours.emplace_back(-points, view);
  std::sort(neighbours.begin(), neighbours.end());
  for (size_t i = 0; i < neighbours.size() && static_cast<int>(i) < options_.weld_neighbours; ++i)
    window.push_back(neighbours[i].second);
  std::sort(window.begin(), window.end());
  return window;
}

std::vector<int> MapBuilder::window_of(const BuildInput& input, const BuiltContacts& before,
                                       const MapModel& model) const {
  std::vector<int> window;
  if (input.scope == BuildScope::kWeld)
    window = weld_window(before, model);
  else
    for (size_t v = 0; v < model.views.size() && !input.fixed.empty(); ++v) window.push_back(static_cast<int>(v));
  std::erase_if(window, [&](int v) { return model.views[v].fixed; });
  return window;
}

MapBuildReport MapBuilder::adjust(const BuildInput& input, const BuiltContacts& before, MapModel* model) const {
  const StageClock clock("map_server.adjust");
  MapBuildReport report;
  const std::vector<int> window = window_of(input, before, *model);
  if (window.empty() && !input.fixed.empty()) return report;  // no image is new
  AssociationOptions association = options_.association;
  const int rounds = input.scope == BuildScope::kAll ? options_.association_rounds : 0;
  BundleSolver solver;
  MapBundleOptions last = options_.bundle;
  last.solver = &solver;
  last.cancel = input.enough ? input.enough : input.cancel;
  // Each association moves the map again, so only the last adjustment must converge.
  MapBundleOptions on_the_way = last;
  on_the_way.function_tolerance = on_the_way.passing_tolerance;
  MapBundleReport bundle = adjust_map(window, rounds > 0 ? on_the_way : last, model);
  for (int round = 0; round < rounds && !input.must_end(); ++round, association.radius_px /= 2) {
    const AssociationReport found = associate(association, window, model);
    report.observed += found.observed;
    report.fused += found.fused;
    bundle = adjust_map(window, round + 1 < rounds ? on_the_way : last, model);
  }
  report.views = static_cast<int>(model->views.size());
  report.adjusted_views = bundle.views;
  report.points = bundle.points;
  report.observations = bundle.observations;
  report.outliers = bundle.outliers;
  report.rmse = bundle.rmse;
  return report;
}

}  // namespace rumi::map_server
