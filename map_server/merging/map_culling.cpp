// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/merging/map_culling.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>
#include <vector>

#include "base/running/stage_clock.h"

namespace rumi::map_server {
namespace {

// A back submap keeps this many of the keyframes that it has in common with another submap, spread over all of them.
constexpr int kKeptJoints = 4;

void need(const KeyframeJoint& joint, KeyframeSets* needed) {
  (*needed)[joint.a.submap].insert(joint.a.id);
  (*needed)[joint.b.submap].insert(joint.b.id);
}

// Marks keyframes of one image as needed if they do not agree: there the back submap's pose is believed, and a refused
// link is compared again when more is known.
void need_what_disagrees(const Submaps& submaps, const std::set<JointName>& agree, KeyframeSets* needed) {
  std::map<ImageId, std::vector<KeyframeRef>> images;
  for (const auto& [key, submap] : submaps)
    for (const auto& [id, keyframe] : submap->keyframes) images[submap->image(keyframe)].push_back({key, id});
  for (const auto& [image, same] : images)
    for (auto a = same.begin(); a != same.end(); ++a)
      for (auto b = std::next(a); b != same.end(); ++b) {
        if (agree.contains({a->submap, a->id, b->submap, b->id})) continue;
        (*needed)[a->submap].insert(a->id);
        (*needed)[b->submap].insert(b->id);
      }
}

}  // namespace

CommonImages common_images(const Submaps& submaps, const LinkGraph& graph) {
  CommonImages common;
  std::set<JointName> agree;
  for (const LinkEdge* edge : graph.edges()) {
    const std::vector<KeyframeJoint>& joints = edge->joints;
    if (edge->link.kind == Link::Kind::kAppearance) {
      for (const KeyframeJoint& joint : joints) need(joint, &common.needed);
      continue;
    }
    const int last = static_cast<int>(joints.size()) - 1, spaces = kKeptJoints - 1;
    for (const KeyframeJoint& joint : joints) agree.insert(name_of(joint));
    common.doubled.insert(common.doubled.end(), joints.begin(), joints.end());
    for (int i = 0; last >= 0 && i <= spaces; ++i) need(joints[(i * last + spaces / 2) / spaces], &common.needed);
  }
  need_what_disagrees(submaps, agree, &common.needed);
  return common;
}

bool MapCulling::stays_joined(const Submap& culled, const Submaps& submaps, const LinkGraph& graph) const {
  return std::all_of(graph.compared.begin(), graph.compared.end(), [&](const auto& item) {
    const auto& [a, b] = item.first;
    const std::optional<LinkEdge>& edge = item.second.edge;
    if (!edge || !edge->link.accepted() || (a != culled.key && b != culled.key)) return true;
    const auto other = submaps.find(a == culled.key ? b : a);
    if (other == submaps.end()) return true;
    const ComparedPair again = a == culled.key ? compare_submaps(culled, *other->second, pairs_)
                                               : compare_submaps(*other->second, culled, pairs_);
    return again.edge && again.edge->link.accepted();
  });
}

CulledSubmaps MapCulling::cull(const BuildInput& input, LinkGraph* graph, AdjustedMap* map) const {
  const StageClock clock("map_server.cull");
  CulledSubmaps culled;
  if (!options_.enabled || !input.fixed.empty()) return culled;
  const KeyframeSets redundant =
      find_redundant(map->model, map->submaps, common_images(input.submaps, *graph), options_);
  if (redundant.empty()) return culled;
  Submaps left = input.submaps;
  for (const auto& [key, keyframes] : redundant) {
    const Submap& before = *input.submaps.at(key);
    auto submap = std::make_shared<const Submap>(without_keyframes(before, map->placements.at(key), keyframes));
    if (input.is_cancelled() || submap->revision == before.revision || !stays_joined(*submap, left, *graph)) continue;
    graph->take_as_compared(key, submap->revision);
    left[key] = map->submaps.at(key).submap = submap.get();
    culled[key] = std::move(submap);
  }
  forget_removed(map->submaps, &map->model);
  Placements left_placed = split(map->model, map->submaps);
  // Keeps the similarities from before: frames hang on them, and they were computed from the removed landmarks too.
  for (auto& [key, placement] : left_placed)
    for (auto& [utime_us, similarity] : placement.map_from_submap) similarity = map->placements.at(key).at(utime_us);
  map->placements = std::move(left_placed);
  return culled;
}

}  // namespace rumi::map_server
