// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/places/place_neighbourhood.h"

#include <fmt/format.h>

#include <map>
#include <set>

namespace rumi::map_server {
namespace {

bool usable(const Keyframe& keyframe) {
  return keyframe.features && keyframe.cam_from_submap.is_finite() && keyframe.features->size() > 0 &&
         keyframe.features->undistorted.size() == keyframe.features->size() &&
         keyframe.features->descriptors.size() == keyframe.features->size() &&
         keyframe.landmark_ids.size() == keyframe.features->size();
}

PlaceView make_view(const Submap& submap, const Keyframe& keyframe) {
  PlaceView view;
  view.keyframe = &keyframe;
  view.landmark_index.assign(keyframe.features->size(), kNone);
  view.grid = KeypointGrid(keyframe.features->undistorted, submap.camera);
  return view;
}

void insert_landmarks(const std::vector<PlaceView>& views, std::set<int>* ids) {
  for (const PlaceView& view : views)
    for (int id : view.keyframe->landmark_ids)
      if (id != kNone) ids->insert(id);
}

// Assigns covisible keyframes in turn to views and witnesses, the most covisible first, because a witness must see the
// same landmarks as the views.
void choose_keyframes(int keyframe_id, const std::set<int>& forbidden, size_t neighbours, size_t witnesses,
                      PlaceNeighbourhood* place) {
  const Submap& submap = *place->submap;
  place->views.push_back(make_view(submap, *submap.keyframe(keyframe_id)));
  bool witness_next = false;
  for (const auto& [id, shared] : submap.covisible_keyframes(keyframe_id)) {
    const bool views_full = place->views.size() > neighbours, witnesses_full = place->witnesses.size() >= witnesses;
    if (views_full && witnesses_full) break;
    const Keyframe* keyframe = submap.keyframe(id);
    if (!keyframe || !usable(*keyframe) || forbidden.contains(id)) continue;
    const bool witness = views_full || (witness_next && !witnesses_full);
    (witness ? place->witnesses : place->views).push_back(make_view(submap, *keyframe));
    witness_next = !witness;
  }
}

void take_landmarks(const std::set<int>& ids, PlaceNeighbourhood* place) {
  std::map<int, int> index;
  for (int id : ids) {
    const Landmark* landmark = place->submap->landmark(id);
    if (!landmark || !landmark->position.allFinite()) continue;
    index[id] = static_cast<int>(place->landmarks.size());
    place->landmarks.push_back({id, landmark->position, {}});
  }
  for (size_t v = 0; v < place->views.size(); ++v) {
    PlaceView& view = place->views[v];
    for (size_t k = 0; k < view.landmark_index.size(); ++k) {
      const auto it = index.find(view.keyframe->landmark_ids[k]);
      if (it == index.end()) continue;
      view.known.push_back(static_cast<int>(k));
      view.landmark_index[k] = it->second;
      place->landmarks[it->second].sightings.push_back({static_cast<int>(v), static_cast<int>(k)});
    }
  }
}

std::set<int> with_covisible(const Submap& submap, int keyframe_id) {
  std::set<int> ids{keyframe_id};
  for (const auto& [id, shared] : submap.covisible_keyframes(keyframe_id)) ids.insert(id);
  return ids;
}

}  // namespace

PlacePair gather_places(const Submap& a, int keyframe_a, const Submap& b, int keyframe_b, int neighbours,
                        int witnesses) {
  PlacePair pair;
  for (const auto& [submap, id] : {std::pair{&a, keyframe_a}, std::pair{&b, keyframe_b}}) {
    const Keyframe* keyframe = submap->keyframe(id);
    if (!keyframe || !usable(*keyframe)) {
      pair.doubt = fmt::format("keyframe {} of submap {} does not exist or has no features or no finite pose", id,
                               submap->key.id);
      return pair;
    }
  }
  pair.a.submap = &a;
  pair.b.submap = &b;
  const bool loop = a.key == b.key;
  std::set<int> near_a, near_b;
  if (loop) {
    near_a = with_covisible(a, keyframe_a);
    near_b = with_covisible(b, keyframe_b);
    if (near_a.contains(keyframe_b)) {
      pair.doubt =
          fmt::format("keyframes {} and {} of submap {} share landmarks already", keyframe_a, keyframe_b, a.key.id);
      return pair;
    }
  }
  choose_keyframes(keyframe_a, near_b, neighbours, witnesses, &pair.a);
  choose_keyframes(keyframe_b, near_a, neighbours, witnesses, &pair.b);
  std::set<int> seen_a, seen_b;
  insert_landmarks(pair.a.views, &seen_a);
  insert_landmarks(pair.b.views, &seen_b);
  if (loop) {
    std::set<int> known_a = seen_a, known_b = seen_b;
    insert_landmarks(pair.a.witnesses, &known_a);
    insert_landmarks(pair.b.witnesses, &known_b);
    std::erase_if(seen_a, [&](int id) { return known_b.contains(id); });
    std::erase_if(seen_b, [&](int id) { return known_a.contains(id); });
  }
  take_landmarks(seen_a, &pair.a);
  take_landmarks(seen_b, &pair.b);
  return pair;
}

}  // namespace rumi::map_server
