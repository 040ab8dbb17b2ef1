// SPDX-License-Identifier: BSD-3-Clause
#include "tests/map_server/synthetic_chain.h"

#include <algorithm>
#include <iterator>
#include <set>

namespace rumi::testing {
using namespace rumi::map_server;

Chain::Chain() : world_(make_room(1)) {
  images_ = film(world_, walk_round(kImages, 0.75), {.most_keypoints = 150, .every = 3});
  for (const SubmapKey key : {kFront1, kBack1, kFront2, kBack2, kFront3})
    made_[key] = make_submap(world_, images_, recipe(key));
  for (const SubmapKey key : {kBack1, kBack2}) made_[key].submap.closed = true;  // they come complete, in one update
}

SubmapRecipe Chain::recipe(SubmapKey key) const {
  static const std::map<SubmapKey, std::pair<int, int>> images = {
      {kFront1, {0, 39}}, {kBack1, {24, 69}}, {kFront2, {54, 99}}, {kBack2, {84, 126}}, {kFront3, {111, 149}}};
  SubmapRecipe recipe{.key = key, .first = images.at(key).first, .last = images.at(key).second};
  recipe.kind = key.id < 0 ? SubmapKind::kBack : SubmapKind::kFront;
  recipe.submap_from_world = random_gauge(static_cast<unsigned>(key.id + 10));
  recipe.seed = static_cast<unsigned>(key.id + 20);
  recipe.wrong_observations = 0.02;
  recipe.wrong_landmarks = 0.03;
  if (key.id > 0) recipe.distortion = drift(images_, recipe.first, key == kFront2 ? -0.001 : 0.001);
  return recipe;
}

Submap Chain::spoiled(SubmapKey key) const {
  SubmapRecipe bad = recipe(key);
  bad.rotation_noise_deg = 10;
  bad.center_noise_m = 0.5;
  bad.wrong_landmarks = 1;
  return make_submap(world_, images_, bad).submap;
}

PathError Chain::error(const Atlas& atlas) const {
  std::vector<Eigen::Vector3d> estimate, truth;
  for (const auto& [key, owner] : atlas.submaps()) {
    if (!owner.in_map) continue;
    for (const auto& [utime_us, frame] : owner.submap.frames) {
      estimate.push_back(owner.placement.cam_from_map(owner.submap, frame).center());
      truth.push_back(images_[(utime_us - images_[0].utime_us) / 100'000].cam_from_world.center());
    }
  }
  return path_error(estimate, truth);
}

Growth grow(const Submap& submap, int early_keyframes) {
  Growth growth{submap, submap};
  Submap& early = growth.early;
  early.closed = false;
  const auto is_late = [&](int keyframe_id) { return keyframe_id >= early_keyframes; };
  std::set<int> late_landmarks;
  for (auto& [id, landmark] : early.landmarks) {
    std::erase_if(landmark.observations, [&](const Observation& o) { return is_late(o.keyframe_id); });
    if (landmark.observations.size() < 2) late_landmarks.insert(id);
  }
  std::erase_if(early.keyframes, [&](const auto& item) { return is_late(item.first); });
  early.frames = {};
  for (const auto& [utime_us, frame] : submap.frames)
    if (!is_late(frame.reference_keyframe)) early.frames.set(frame);
  for (int id : late_landmarks) early.landmarks.erase(id);
  for (auto& [id, keyframe] : early.keyframes)
    for (int& landmark : keyframe.landmark_ids)
      if (late_landmarks.contains(landmark)) landmark = kNone;

  growth.late.revision = submap.revision + 1;
  for (auto& [id, keyframe] : growth.late.keyframes) {
    keyframe.revision = growth.late.revision;
    if (is_late(id)) keyframe.created_revision = growth.late.revision;
  }
  for (int id : late_landmarks) growth.late.landmark(id)->revision = growth.late.revision;
  growth.late.frames.change_all([&](FramePose* frame) {
    if (is_late(frame->reference_keyframe)) frame->revision = growth.late.revision;
  });
  return growth;
}

void break_submap(Submap* submap) {
  const auto before = submap->landmarks;
  const auto middle = std::next(submap->keyframes.begin(), static_cast<std::ptrdiff_t>(submap->keyframes.size() / 2));
  submap->remove_keyframe(middle->first, std::next(middle)->first);
  submap->landmarks = before;
}

void put(const Submap& submap, Atlas* atlas) {
  EXPECT_TRUE(atlas->change_submap(submap.key, [&](Submap* there) {
    *there = submap;
    return Result<>();
  }));
}

}  // namespace rumi::testing
