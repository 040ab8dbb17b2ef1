// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/merging/link_finder.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <map>
#include <utility>

#include "base/running/due.h"
#include "base/running/stage_clock.h"
#include "map_server/links/may_share_images.h"
#include "map_server/merging/map_members.h"

namespace rumi::map_server {
namespace {

// At the first call, fills tied_before from the placed maps. Then drops the pairs that edges join meanwhile.
void update_tied_before(const BuildInput& input, LinkGraph* graph) {
  if (!std::exchange(graph->knows_tied_before, true))
    for (const Placements* map : {&input.placed, &input.beside})
      for (const auto& [key, placement] : *map) graph->tied_before.emplace_back(map->begin()->first, key);
  Groups tied = graph->tied();
  std::erase_if(graph->tied_before,
                [&](const SubmapPair& pair) { return tied.find(pair.first) == tied.find(pair.second); });
}

}  // namespace

LinkGraph LinkFinder::find(LinkGraph graph, const BuildInput& input) {
  const StageClock clock("map_server.links");
  compare(input, &graph);
  search_places(input, &graph);
  update_tied_before(input, &graph);
  if (input.scope != BuildScope::kWeld) search_beside_members(input, &graph);
  return graph;
}

void LinkFinder::compare(const BuildInput& input, LinkGraph* graph) const {
  for (auto a = input.submaps.begin(); a != input.submaps.end(); ++a)
    for (auto b = std::next(a); b != input.submaps.end() && !input.is_cancelled(); ++b) {
      if (input.fixed.contains(a->first) && input.fixed.contains(b->first)) continue;
      if (!may_share_images(*a->second, *b->second)) {  // true of most pairs of a large map, so nothing is stored
        graph->compared.erase({a->first, b->first});
        continue;
      }
      ComparedPair& pair = graph->compared[{a->first, b->first}];
      if (pair.revision_a == a->second->revision && pair.revision_b == b->second->revision) continue;
      // A submap that grows elsewhere need not be compared again where the two were found to fit together.
      const SharedState shared = shared_state(*a->second, *b->second);
      if (pair.edge && pair.edge->link.accepted() && pair.shared == shared) {
        pair.revision_a = a->second->revision;
        pair.revision_b = b->second->revision;
        continue;
      }
      pair = compare_submaps(*a->second, *b->second, options_.pairs);
      pair.shared = shared;
    }
}

bool LinkFinder::is_joined(const LinkGraph& graph, const Place& a, const Place& b) const {
  if (graph.are_joined(a.image, b.image)) return true;
  if (a.submap == b.submap) return false;
  const LinkEdge* edge = graph.edge_between(a.submap, b.submap);
  if (!edge) return false;
  if (edge->link.accepted())
    return a.image.stream == b.image.stream &&
           static_cast<double>(std::abs(a.image.utime_us - b.image.utime_us)) <= options_.places.min_apart_s * 1e6;
  // Submaps whose common images do not fit together are torn: their similar looks prove nothing then.
  return edge->link.keyframes >= kMinSharedKeyframes && edge->link.landmarks >= options_.pairs.alignment.min_landmarks;
}

void LinkFinder::search_places(const BuildInput& input, LinkGraph* graph) {
  for (const SubmapKey& key : input.fixed) places_.add(*input.submaps.at(key), &graph->places);
  const auto joined = [&](const Place& a, const Place& b) { return input.is_cancelled() || is_joined(*graph, a, b); };
  std::map<int64_t, int64_t> newest_us;  // time of the newest image, by session
  for (const auto& [key, submap] : input.submaps)
    if (!submap->frames.empty()) {
      int64_t& newest = newest_us.try_emplace(key.session, kNever_us).first->second;
      newest = std::max(newest, submap->frames.rbegin()->first);
    }
  const auto settled_us = static_cast<int64_t>(options_.places.settled_s * 1e6);
  const auto waits = [&](const Place& place) {
    if (input.scope == BuildScope::kAll || !graph->built.submaps.contains(place.submap)) return false;
    const auto newest = newest_us.find(place.submap.session);
    return newest != newest_us.end() && place.image.utime_us > newest->second - settled_us;
  };
  places_.search(input.submaps, joined, &graph->places, waits);
}

void LinkFinder::search_beside_members(const BuildInput& input, LinkGraph* graph) {
  const std::set<SubmapKey> members = choose_members(*graph, input);
  std::set<SubmapKey> beside;
  for (const auto& [key, submap] : input.submaps)
    if (!members.contains(key)) beside.insert(key);
  const auto joined = [&](const Place& a, const Place& b) {
    return input.must_end() || beside.contains(b.submap) || is_joined(*graph, a, b);
  };
  places_.search_again(beside, input.submaps, joined, &graph->places);
}

}  // namespace rumi::map_server
