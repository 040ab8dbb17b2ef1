// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/merging/arrangement.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "map_server/merging/map_members.h"
#include "slam/numeric/median.h"

namespace rumi::map_server {
namespace {

// Chooses the members that are arranged: for a weld those around the new ones, otherwise all.
MapPart choose_part(const BuildInput& input, const LinkGraph& graph, const std::set<SubmapKey>& members,
                    const Placements& placed, int weld_keyframes) {
  std::set<SubmapKey> fresh;
  for (const SubmapKey& key : members)
    if (!graph.built.submaps.contains(key) || !placed.contains(key)) fresh.insert(key);
  if (input.scope != BuildScope::kWeld || fresh.empty()) return {members, {}};
  return part_around(fresh, members, graph.contacts(), input.submaps, weld_keyframes);
}

// Chooses the anchor among the submaps that are placed in the map, if there are any, and prefers front submaps, because
// a front submap is never shortened at its beginning.
SubmapKey choose_anchor(const BuildInput& input, const MapPart& part, const Placements& placed) {
  if (!part.fixed.empty()) return *part.fixed.begin();
  const auto is_placed = [&](SubmapKey key) {
    return input.fixed.empty() ? placed.contains(key) : input.fixed.contains(key);
  };
  SubmapKey anchor;
  std::tuple<bool, bool, size_t> best;
  for (const SubmapKey& key : part.submaps) {
    const Submap& submap = *input.submaps.at(key);
    if (submap.frames.empty()) continue;
    const bool is_front = submap.kind == SubmapKind::kFront;
    const std::tuple rank(is_placed(key), is_front, is_placed(key) ? 1 : submap.frames.size());
    if (rank <= best) continue;
    best = rank;
    anchor = key;
  }
  return anchor;
}

// Returns the placement with the same similarity at every keyframe.
Placement rigid(const Submap& submap, const Sim3& map_from_submap) {
  Placement placement;
  for (const auto& [id, keyframe] : submap.keyframes) placement.map_from_submap[keyframe.utime_us] = map_from_submap;
  return placement;
}

PlacedSubmaps place_part(const BuildInput& input, const LinkGraph& graph, const MapPart& part, SubmapKey anchor,
                         const Placements& placed) {
  PlacedSubmaps result;
  std::set<SubmapKey> first{anchor};
  for (const SubmapKey& key : part.submaps)
    if (const auto where = placed.find(key); where != placed.end()) {
      const bool stays = input.fixed.contains(key) || part.fixed.contains(key);
      result[key] = {input.submaps.at(key), where->second, stays};
      first.insert(key);
    }
  const auto add = [&](SubmapKey key, const Sim3& map_from_submap) {
    const Submap& submap = *input.submaps.at(key);
    result[key] = {&submap, rigid(submap, map_from_submap)};
  };
  if (!result.contains(anchor)) add(anchor, {});
  for (const LinkEdge* edge : graph.placing_order(first, part.submaps)) {
    const Link& link = edge->link;
    if (result.contains(link.a))
      add(link.b, result.at(link.a).placement.at(edge->utime_a_us) * link.b_from_a.inverse());
    else
      add(link.a, result.at(link.b).placement.at(edge->utime_b_us) * link.b_from_a);
  }
  return result;
}

// An edge with those of its joints whose keyframes still exist.
struct BentEdge {
  const LinkEdge* edge = nullptr;
  LinkJoints joints = {};
};

std::vector<BentEdge> edges_between(const PlacedSubmaps& submaps, const LinkGraph& graph) {
  const auto is_here = [&](const KeyframeRef& ref) {
    const auto owner = submaps.find(ref.submap);
    return owner != submaps.end() && owner->second.submap->keyframe(ref.id);
  };
  std::vector<BentEdge> edges;
  for (const LinkEdge* edge : graph.edges()) {
    BentEdge bent{edge};
    for (const KeyframeJoint& joint : edge->joints)
      if (is_here(joint.a) && is_here(joint.b)) bent.joints.push_back(joint);
    if (!bent.joints.empty()) edges.push_back(std::move(bent));
  }
  return edges;
}

bool is_of_same_images(const BentEdge& edge) { return edge.edge->link.kind == Link::Kind::kSameImages; }

MapGraphReport bend_part(const BuildInput& input, const LinkGraph& graph, const std::vector<BentEdge>& edges,
                         const MapGraphOptions& options, Arrangement* arranged) {
  std::vector<LinkJoints> joints;
  joints.reserve(edges.size());
  for (const BentEdge& edge : edges) joints.push_back(edge.joints);
  const auto may_be_wrong = [&](size_t i) {
    return !is_of_same_images(edges[i]) || !graph.is_only(*edges[i].edge, input.submaps);
  };
  return bend(joints, may_be_wrong, arranged->anchor, options, &arranged->submaps);
}

// Refuses the links that the other links contradict. Returns true if there were any.
bool refuse_contradicted(const std::vector<BentEdge>& edges, const MapGraphReport& report, LinkGraph* graph) {
  std::map<const LinkEdge*, std::string> doubts;
  for (size_t i = 0; i < edges.size() && report.bent; ++i) {
    if (!report.is_wrong[i]) continue;
    std::vector<double> chi2 = report.joint_chi2[i];
    doubts[edges[i].edge] = fmt::format("the rest of the map contradicts it, chi2 {:.0f}", median(&chi2));
  }
  graph->refuse(doubts);
  return !doubts.empty();
}

// Drops those joints of edges between submaps with common images whose chi2 is larger than `most`. If that is most of
// an edge's joints, only the worst joint is dropped, because nothing else connects the two sides. Returns true if any
// joint was dropped.
bool drop_worst_joints(const std::vector<BentEdge>& edges, const MapGraphReport& report, double most,
                       LinkGraph* graph) {
  bool dropped = false;
  for (size_t i = 0; i < edges.size() && report.bent; ++i) {
    if (!is_of_same_images(edges[i])) continue;
    std::vector<double> all = report.joint_chi2[i];
    // One of the two submaps is bent between these joints, since no other edge contradicts them. The worst joint goes
    // first, so that those that agree best remain.
    const bool one_by_one = median(&all) > most;
    const double worst = *std::max_element(report.joint_chi2[i].begin(), report.joint_chi2[i].end());
    std::set<JointName> gone;
    for (size_t j = 0; j < edges[i].joints.size(); ++j)
      if (const double chi2 = report.joint_chi2[i][j]; one_by_one ? chi2 == worst : chi2 > most)
        gone.insert(name_of(edges[i].joints[j]));
    graph->forget_joints(*edges[i].edge, gone);
    dropped = dropped || !gone.empty();
  }
  return dropped;
}

}  // namespace

std::optional<Arrangement> arrange(std::set<SubmapKey> members, const BuildInput& input,
                                   const ArrangementOptions& options, LinkGraph* graph) {
  for (;; members = choose_members(*graph, input)) {
    const bool joins_beside =
        std::any_of(members.begin(), members.end(), [&](const SubmapKey& key) { return input.beside.contains(key); });
    const Placements& placed = joins_beside ? input.beside : input.placed;
    Arrangement arranged{.members = members};
    arranged.part = choose_part(input, *graph, members, placed, options.weld_keyframes);
    arranged.anchor = choose_anchor(input, arranged.part, placed);
    if (!arranged.part.submaps.contains(arranged.anchor) || input.is_cancelled()) return std::nullopt;
    arranged.submaps = place_part(input, *graph, arranged.part, arranged.anchor, placed);
    const std::vector<BentEdge> edges = edges_between(arranged.submaps, *graph);
    if (edges.empty() && input.scope != BuildScope::kWeld && members.size() == 1) return arranged;  // one submap
    if (edges.empty()) return std::nullopt;
    const MapGraphReport report = bend_part(input, *graph, edges, options.graph, &arranged);
    if (!refuse_contradicted(edges, report, graph) &&
        !drop_worst_joints(edges, report, options.graph.max_joint_chi2, graph))
      return arranged;
  }
}

}  // namespace rumi::map_server
