// SPDX-License-Identifier: BSD-3-Clause
// What post-culling leaves out of a map that has been built.
#include <algorithm>

#include "base/stage_clock.h"
#include "map_server/merging/map_builder.h"

namespace rumi::map_server {

// Keyframes kept of those that a back submap has in common with another submap, spread over them.
constexpr int kKeptJoints = 4;

CommonImages MapBuilder::common_images(const Submaps& submaps) const {
  CommonImages common;
  std::set<JointName> agree;
  for (const auto& [keys, pair] : pairs_) {
    const int last = static_cast<int>(pair.joints.size()) - 1, spaces = kKeptJoints - 1;
    for (int i = 0; i <= last; ++i) agree.insert(name_of(pair.joints[i]));
    common.doubled.insert(common.doubled.end(), pair.joints.begin(), pair.joints.end());
    for (int i = 0; last >= 0 && i <= spaces; ++i) {
      const KeyframeJoint& kept = pair.joints[(i * last + spaces / 2) / spaces];
      common.needed[kept.a.submap].insert(kept.a.id);
      common.needed[kept.b.submap].insert(kept.b.id);
    }
  }
  for (const PlaceLink& place : places_.found()) {
    common.needed[place.joint.a.submap].insert(place.joint.a.id);
    common.needed[place.joint.b.submap].insert(place.joint.b.id);
  }
  // Where two do not agree, the back submap is believed; and what was refused is tried again when more is known.
  std::map<ImageId, std::vector<KeyframeRef>> images;
  for (const auto& [key, submap] : submaps)
    for (const auto& [id, keyframe] : submap->keyframes) images[submap->image(keyframe)].push_back({key, id});
  for (const auto& [image, same] : images)
    for (auto a = same.begin(); a != same.end(); ++a)
      for (auto b = std::next(a); b != same.end(); ++b) {
        if (agree.contains({a->submap, a->id, b->submap, b->id})) continue;
        common.needed[a->submap].insert(a->id);
        common.needed[b->submap].insert(b->id);
      }
  return common;
}

bool MapBuilder::stays_joined(const Submap& culled, const Submaps& submaps) const {
  return std::all_of(pairs_.begin(), pairs_.end(), [&](const auto& item) {
    const auto& [a, b] = item.first;
    if (!item.second.link || !item.second.link->accepted() || (a != culled.key && b != culled.key)) return true;
    const auto other = submaps.find(a == culled.key ? b : a);
    if (other == submaps.end()) return true;
    const Pair again = a == culled.key ? compare_submaps(culled, *other->second, options_.pairs)
                                       : compare_submaps(*other->second, culled, options_.pairs);
    return again.link && again.link->accepted();
  });
}

// No need to compare it again with what has not changed either.
void MapBuilder::note_culled(const Submap& culled) {
  for (auto& [keys, pair] : pairs_) {
    if (keys.first == culled.key && pair.revision_a == culled.revision - 1) pair.revision_a = culled.revision;
    if (keys.second == culled.key && pair.revision_b == culled.revision - 1) pair.revision_b = culled.revision;
  }
}

CulledSubmaps MapBuilder::cull(const Submaps& submaps, Placed* placed, MapModel* model, Placements* placements) {
  const StageClock clock("map_server.cull");
  CulledSubmaps culled;
  if (!options_.culling.enabled) return culled;
  const KeyframeSets redundant = find_redundant(*model, *placed, common_images(submaps), options_.culling);
  if (redundant.empty()) return culled;
  Submaps left = submaps;
  for (const auto& [key, keyframes] : redundant) {
    auto submap = std::make_shared<const Submap>(without_keyframes(*submaps.at(key), placements->at(key), keyframes));
    if (cancelled() || submap->revision == submaps.at(key)->revision || !stays_joined(*submap, left)) continue;
    note_culled(*submap);
    left[key] = placed->at(key).submap = submap.get();
    culled[key] = std::move(submap);
  }
  forget_removed(*placed, model);
  Placements left_placed = split(*model, *placed);
  for (auto& [key, placement] : left_placed)  // which the frames hang on: of all landmarks, not of those that are left
    for (auto& [utime_us, similarity] : placement.map_from_submap) similarity = placements->at(key).at(utime_us);
  *placements = std::move(left_placed);
  return culled;
}

}  // namespace rumi::map_server
