// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/merging/map_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <tuple>
#include <utility>

#include "base/stage_clock.h"
#include "slam/numeric/median.h"

namespace rumi::map_server {
namespace {

// The same similarity at every keyframe.
Placement rigid(const Submap& submap, const Sim3& map_from_submap) {
  Placement placement;
  for (const auto& [id, keyframe] : submap.keyframes) placement.map_from_submap[keyframe.utime_us] = map_from_submap;
  return placement;
}

struct GroupSize {
  std::set<ImageId> frames;
  size_t preferred_frames = 0;
  bool has_front = false;  // which decides between equals

  bool operator<(const GroupSize& other) const {
    return std::tuple(preferred_frames, frames.size(), has_front) <
           std::tuple(other.preferred_frames, other.frames.size(), other.has_front);
  }
};

// An adjustment leaves the map's unit and place open: the anchor's first keyframe stays where it was.
void keep_gauge(const PlacedSubmap& anchor_before, SubmapKey anchor, std::map<SubmapKey, Placement>* placements) {
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

}  // namespace

void MapBuilder::fix(std::set<SubmapKey> submaps) {
  built_ = fixed_ = std::move(submaps);
  options_.culling.enabled = false;
}

void MapBuilder::find_links(const Submaps& submaps) {
  const StageClock clock("map_server.links");
  for (auto a = submaps.begin(); a != submaps.end(); ++a)
    for (auto b = std::next(a); b != submaps.end() && !cancelled(); ++b) {
      if (fixed_.contains(a->first) && fixed_.contains(b->first)) continue;
      if (!may_share_images(*a->second, *b->second)) {  // as most pairs of a large map: nothing is kept of them
        pairs_.erase({a->first, b->first});
        continue;
      }
      Pair& pair = pairs_[{a->first, b->first}];
      if (pair.revision_a == a->second->revision && pair.revision_b == b->second->revision) continue;
      pair = compare_submaps(*a->second, *b->second, options_.pairs);
    }
  for (const SubmapKey& key : fixed_) places_.add(*submaps.at(key));
  places_.search(submaps, [this](const Place& a, const Place& b) { return cancelled() || is_joined(a, b); });
}

bool MapBuilder::is_joined(const Place& a, const Place& b) const {
  if (joined_.contains(std::minmax(a.image, b.image))) return true;
  if (a.submap == b.submap) return false;
  const auto pair = pairs_.find(std::minmax(a.submap, b.submap));
  if (pair == pairs_.end() || !pair->second.link) return false;
  const Link& link = *pair->second.link;
  if (link.accepted())
    return a.image.stream == b.image.stream &&
           static_cast<double>(std::abs(a.image.utime_us - b.image.utime_us)) <= options_.places.min_apart_s * 1e6;
  // Where the same images do not fit together, that they look alike says nothing new: one of the submaps is torn.
  return link.keyframes >= kMinSharedKeyframes && link.landmarks >= options_.pairs.alignment.min_landmarks;
}

std::vector<Link> MapBuilder::links() const {
  std::vector<Link> links;
  for (const auto& [keys, pair] : pairs_)
    if (pair.link) links.push_back(*pair.link);
  std::map<std::pair<SubmapKey, SubmapKey>, Link> places = places_.refused();
  for (const PlaceLink& place : places_.found()) {
    Link& best = places[std::minmax(place.link.a, place.link.b)];
    if (!best.accepted() || best.landmark_inliers < place.link.landmark_inliers) best = place.link;
  }
  for (const auto& [keys, link] : places) links.push_back(link);
  return links;
}

std::vector<MapBuilder::Tie> MapBuilder::ties(const Submaps& submaps) const {
  std::vector<Tie> ties;
  const auto exists = [&](const Link& link) { return submaps.contains(link.a) && submaps.contains(link.b); };
  for (const auto& [keys, pair] : pairs_)
    if (pair.link && pair.link->accepted() && exists(*pair.link))
      ties.push_back({&*pair.link, pair.utime_us, pair.utime_us});
  for (const PlaceLink& place : places_.found())
    if (exists(place.link)) ties.push_back({&place.link, place.utime_a_us, place.utime_b_us});
  return ties;
}

// Also by what is not here now: that it is left out for a while says nothing against what hangs on it.
Groups MapBuilder::tied() const {
  Groups groups;
  for (const auto& [keys, pair] : pairs_)
    if (pair.link && pair.link->accepted()) groups.unite(pair.link->a, pair.link->b);
  for (const PlaceLink& place : places_.found()) groups.unite(place.link.a, place.link.b);
  return groups;
}

void MapBuilder::inherit(const Placements& placed, const Placements& kept) {
  Groups groups = tied();
  if (!std::exchange(has_inherited_, true))
    for (const Placements* map : {&placed, &kept})
      for (const auto& [key, placement] : *map) inherited_.emplace_back(map->begin()->first, key);
  std::erase_if(inherited_, [&](const auto& edge) { return groups.find(edge.first) == groups.find(edge.second); });
}

std::set<SubmapKey> MapBuilder::choose_members(const Submaps& submaps) const {
  Groups groups = tied();
  for (const auto& [a, b] : inherited_) groups.unite(a, b);
  for (const SubmapKey& key : fixed_) groups.unite(key, *fixed_.begin());
  std::map<size_t, GroupSize> sizes;
  for (const auto& [key, submap] : submaps) {
    GroupSize& size = sizes[groups.find(key)];
    size.has_front = size.has_front || submap->kind == SubmapKind::kFront;
    const size_t before = size.frames.size();
    for (const auto& [utime_us, frame] : submap->frames) size.frames.insert({utime_us, submap->stream});
    if (preferred_.contains(key.session)) size.preferred_frames += size.frames.size() - before;
  }
  if (!fixed_.empty()) std::erase_if(sizes, [&](const auto& g) { return g.first != groups.find(*fixed_.begin()); });
  const auto largest =
      std::max_element(sizes.begin(), sizes.end(), [](const auto& x, const auto& y) { return x.second < y.second; });
  std::set<SubmapKey> members;
  if (largest == sizes.end()) return members;
  for (const auto& [key, submap] : submaps)
    if (groups.find(key) == largest->first) members.insert(key);
  return members;
}

std::set<SubmapKey> MapBuilder::search_beside(const std::set<SubmapKey>& members, const Submaps& submaps) {
  std::set<SubmapKey> beside;
  for (const auto& [key, submap] : submaps)
    if (!members.contains(key)) beside.insert(key);
  const auto joined = [&](const Place& a, const Place& b) {
    return cancelled() || beside.contains(b.submap) || is_joined(a, b);
  };
  return places_.search_again(beside, submaps, joined) ? choose_members(submaps) : members;
}

MapPart MapBuilder::part_of(Scope scope, const std::set<SubmapKey>& members, const Submaps& submaps,
                            const Placements& placed) const {
  std::set<SubmapKey> fresh;
  for (const SubmapKey& key : members)
    if (!built_.contains(key) || !placed.contains(key)) fresh.insert(key);
  if (scope != Scope::kWeld || fresh.empty()) return {members, {}};
  SubmapContacts contacts = fused_;
  for (const Tie& tie : ties(submaps)) contacts.insert(std::minmax(tie.link->a, tie.link->b));
  return part_around(fresh, members, contacts, submaps, options_.weld_keyframes);
}

SubmapKey MapBuilder::choose_anchor(const Submaps& submaps, const MapPart& part, const Placements& placed) const {
  if (!part.held.empty()) return *part.held.begin();
  // Where the map lies already, a submap of it: a front submap if there is one, whose beginning nothing takes away.
  const auto is_placed = [&](SubmapKey key) { return fixed_.empty() ? placed.contains(key) : fixed_.contains(key); };
  SubmapKey anchor;
  std::tuple<bool, bool, size_t> best;
  for (const SubmapKey& key : part.submaps) {
    const Submap& submap = *submaps.at(key);
    if (submap.frames.empty()) continue;
    const bool is_front = submap.kind == SubmapKind::kFront;
    const std::tuple rank(is_placed(key), is_front, is_placed(key) ? 1 : submap.frames.size());
    if (rank <= best) continue;
    best = rank;
    anchor = key;
  }
  return anchor;
}

// One after another, over the link with most inliers each time.
MapBuilder::Placed MapBuilder::place_members(const Submaps& submaps, const MapPart& part, SubmapKey anchor,
                                             const Placements& placed) const {
  Placed result;
  for (const SubmapKey& key : part.submaps)
    if (const auto place = placed.find(key); place != placed.end())
      result[key] = {submaps.at(key), place->second, fixed_.contains(key) || part.held.contains(key)};
  if (!result.contains(anchor)) result[anchor] = {submaps.at(anchor), rigid(*submaps.at(anchor), {})};
  const std::vector<Tie> all = ties(submaps);
  for (;;) {
    const Tie* best = nullptr;
    for (const Tie& tie : all)
      if (part.submaps.contains(tie.link->a) && part.submaps.contains(tie.link->b) &&
          result.contains(tie.link->a) != result.contains(tie.link->b) &&
          (!best || tie.link->landmark_inliers > best->link->landmark_inliers))
        best = &tie;
    if (!best) return result;
    const Link& link = *best->link;
    if (result.contains(link.a)) {
      const Sim3 map_from_b = result.at(link.a).placement.at(best->utime_a_us) * link.b_from_a.inverse();
      result[link.b] = {submaps.at(link.b), rigid(*submaps.at(link.b), map_from_b)};
    } else {
      const Sim3 map_from_a = result.at(link.b).placement.at(best->utime_b_us) * link.b_from_a;
      result[link.a] = {submaps.at(link.a), rigid(*submaps.at(link.a), map_from_a)};
    }
  }
}

// Of those whose keyframes are still there.
std::vector<MapBuilder::KnownLink> MapBuilder::known_links(const Placed& submaps) {
  std::vector<KnownLink> links;
  const auto is_here = [&](const KeyframeRef& ref) {
    const auto owner = submaps.find(ref.submap);
    return owner != submaps.end() && owner->second.submap->keyframe(ref.id);
  };
  const auto add = [&](KnownLink link, const LinkJoints& joints) {
    for (const KeyframeJoint& joint : joints)
      if (is_here(joint.a) && is_here(joint.b)) link.joints.push_back(joint);
    if (!link.joints.empty()) links.push_back(std::move(link));
  };
  for (auto& [keys, pair] : pairs_)
    if (pair.link && pair.link->accepted()) add({.pair = &pair}, pair.joints);
  for (size_t i = 0; i < places_.found().size(); ++i) add({.place = static_cast<int>(i)}, {places_.found()[i].joint});
  return links;
}

void MapBuilder::fuse_places(Placed* submaps) const {
  for (const PlaceLink& place : places_.found()) {
    const auto a = submaps->find(place.link.a);
    if (a == submaps->end() || !submaps->contains(place.link.b)) continue;
    for (const LandmarkPair& pair : place.landmarks)
      a->second.placement.fused.try_emplace(pair.a, LandmarkRef{place.link.b, pair.b});
  }
}

bool MapBuilder::is_only_tie(const Link& link, const Submaps& submaps) const {
  Groups groups;
  for (const Tie& tie : ties(submaps))
    if (tie.link != &link) groups.unite(tie.link->a, tie.link->b);
  return groups.find(link.a) != groups.find(link.b);
}

bool MapBuilder::drop_contradicted(const std::vector<KnownLink>& links, const MapGraphReport& bent) {
  size_t dropped = 0;
  for (size_t i = links.size(); i-- > 0;) {  // from the last on: so the numbers of places stay right
    if (!bent.bent || !bent.is_wrong[i]) continue;
    std::vector<double> chi2 = bent.joint_chi2[i];
    const std::string doubt = fmt::format("the rest of the map contradicts it, chi2 {:.0f}", median(&chi2));
    if (links[i].pair) {
      links[i].pair->link->doubt = doubt;
      links[i].pair->joints.clear();
    } else {
      places_.refuse(links[i].place, doubt);
    }
    ++dropped;
  }
  return dropped > 0;
}

bool MapBuilder::drop_worst_joints(const std::vector<KnownLink>& links, const MapGraphReport& bent) {
  const double most = options_.graph.max_joint_chi2;
  size_t dropped = 0;
  for (size_t i = 0; i < links.size() && bent.bent; ++i) {
    if (!links[i].pair) continue;
    std::vector<double> all = bent.joint_chi2[i];
    // Nothing else says otherwise: one of the two is bent between their joints, and they hold where they agree best.
    const bool one_by_one = median(&all) > most;
    const double worst = *std::max_element(bent.joint_chi2[i].begin(), bent.joint_chi2[i].end());
    std::set<JointName> gone;
    for (size_t j = 0; j < links[i].joints.size(); ++j)
      if (const double chi2 = bent.joint_chi2[i][j]; one_by_one ? chi2 == worst : chi2 > most)
        gone.insert(name_of(links[i].joints[j]));
    dropped += std::erase_if(links[i].pair->joints, [&](const KeyframeJoint& j) { return gone.contains(name_of(j)); });
  }
  return dropped > 0;
}

std::optional<MapBuilder::Arranged> MapBuilder::arrange(Scope scope, const Submaps& submaps, const Placements& in_map,
                                                        const Placements& kept, std::set<SubmapKey>* members) {
  for (;;) {
    const bool joins_kept =
        std::any_of(members->begin(), members->end(), [&](const SubmapKey& key) { return kept.contains(key); });
    const Placements& placed = joins_kept ? kept : in_map;
    Arranged arranged;
    arranged.part = part_of(scope, *members, submaps, placed);
    arranged.anchor = choose_anchor(submaps, arranged.part, placed);
    if (!arranged.part.submaps.contains(arranged.anchor) || cancelled()) return std::nullopt;
    arranged.submaps = place_members(submaps, arranged.part, arranged.anchor, placed);
    const std::vector<KnownLink> known = known_links(arranged.submaps);
    if (known.empty() && scope != Scope::kWeld && members->size() == 1) return arranged;  // it is the whole map
    if (known.empty()) return std::nullopt;
    std::vector<LinkJoints> joints;
    joints.reserve(known.size());
    for (const KnownLink& link : known) joints.push_back(link.joints);
    const auto may_be_wrong = [&](size_t i) { return !known[i].pair || !is_only_tie(*known[i].pair->link, submaps); };
    const MapGraphReport bent = bend(joints, may_be_wrong, arranged.anchor, options_.graph, &arranged.submaps);
    if (!drop_contradicted(known, bent) && !drop_worst_joints(known, bent)) return arranged;
    *members = choose_members(submaps);
  }
}

BuiltMap MapBuilder::build(const Submaps& submaps, const Placements& placed, Scope scope, const Placements& kept) {
  const StageClock clock("map_server.place");
  inherit(placed, kept);
  std::set<SubmapKey> members = choose_members(submaps);
  if (scope != Scope::kWeld) members = search_beside(members, submaps);
  BuiltMap built;
  built.report.members = static_cast<int>(members.size());
  if (members.empty() || cancelled() || members == fixed_ || (scope == Scope::kWeld && members == built_)) return built;
  std::optional<Arranged> arranged = arrange(scope, submaps, placed, kept, &members);
  if (!arranged) return built;
  Placed& before = arranged->submaps;
  const std::set<SubmapKey>& part = arranged->part.submaps;
  fuse_places(&before);
  MapModel model = join(before, kSameKeypointPx);
  built.report = adjust(scope, &model);
  built.report.members = static_cast<int>(members.size());
  if (cancelled()) return built;
  note_joined(model, part == members);
  built_ = members;
  built.placements = split(model, before);
  std::set_difference(members.begin(), members.end(), part.begin(), part.end(),
                      std::inserter(built.unmoved, built.unmoved.end()));
  if (scope != Scope::kWeld) built.culled = cull(submaps, &before, &model, &built.placements);
  if (fixed_.empty() && arranged->part.held.empty())
    keep_gauge(before.at(arranged->anchor), arranged->anchor, &built.placements);
  return built;
}

// The views of what is new, and those that share most points with them.
std::vector<int> MapBuilder::weld_window(const MapModel& model) const {
  std::vector<int> window;
  std::map<int, int> shared;
  for (size_t v = 0; v < model.views.size(); ++v) {
    const auto is_new = [&](const KeyframeRef& ref) { return !built_.contains(ref.submap); };
    if (std::none_of(model.views[v].keyframes.begin(), model.views[v].keyframes.end(), is_new)) continue;
    window.push_back(static_cast<int>(v));
    for (int point : model.views[v].points)
      if (point != kNone)
        for (const MapModel::Observation& o : model.points[point].observations) ++shared[o.view];
  }
  for (int view : window) shared.erase(view);
  std::vector<std::pair<int, int>> neighbours;  // points, view
  neighbours.reserve(shared.size());
  for (const auto& [view, points] : shared) neighbours.emplace_back(-points, view);
  std::sort(neighbours.begin(), neighbours.end());
  for (size_t i = 0; i < neighbours.size() && static_cast<int>(i) < options_.weld_neighbours; ++i)
    window.push_back(neighbours[i].second);
  std::sort(window.begin(), window.end());
  return window;
}

std::vector<int> MapBuilder::window_of(Scope scope, const MapModel& model) const {
  std::vector<int> window;
  if (scope == Scope::kWeld)
    window = weld_window(model);
  else
    for (size_t v = 0; v < model.views.size() && !fixed_.empty(); ++v) window.push_back(static_cast<int>(v));
  std::erase_if(window, [&](int v) { return model.views[v].fixed; });
  return window;
}

MapBuildReport MapBuilder::adjust(Scope scope, MapModel* model) const {
  const StageClock clock("map_server.adjust");
  MapBuildReport report;
  const std::vector<int> window = window_of(scope, *model);
  if (window.empty() && !fixed_.empty()) return report;  // no image is new
  AssociationOptions association = options_.association;
  const int rounds = scope == Scope::kAll ? options_.association_rounds : 0;
  BundleSolver solver;
  MapBundleOptions last = options_.bundle;
  last.solver = &solver;
  // What is associated next moves the map again: only after the last round it must be where it belongs.
  MapBundleOptions on_the_way = last;
  on_the_way.function_tolerance = on_the_way.passing_tolerance;
  MapBundleReport bundle = adjust_map(window, rounds > 0 ? on_the_way : last, model);
  for (int round = 0; round < rounds && !cancelled(); ++round, association.radius_px /= 2) {
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

void MapBuilder::note_joined(const MapModel& model, bool whole) {
  if (whole) {
    joined_.clear();
    fused_.clear();
  }
  std::vector<int> shared(model.views.size(), 0), met;  // points that each earlier view has in common with this one
  for (size_t v = 0; v < model.views.size(); ++v) {
    for (int point : model.views[v].points)
      if (point != kNone)
        for (const MapModel::Observation& o : model.points[point].observations)
          if (o.view < static_cast<int>(v) && shared[o.view]++ == 0) met.push_back(o.view);
    for (int other : met)
      if (std::exchange(shared[other], 0) >= options_.joined_points)
        joined_.insert(std::minmax(model.views[other].image, model.views[v].image));
    met.clear();
  }
  for (const MapModel::Point& point : model.points)
    for (size_t i = 0; i < point.landmarks.size(); ++i)
      for (size_t j = 0; j < i; ++j)
        if (point.landmarks[i].submap != point.landmarks[j].submap)
          fused_.insert(std::minmax(point.landmarks[i].submap, point.landmarks[j].submap));
}

}  // namespace rumi::map_server
