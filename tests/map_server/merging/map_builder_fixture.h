// SPDX-License-Identifier: BSD-3-Clause
// Five connected submaps, and the error of a map of them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <vector>

#include "tests/map_server/merging/map_maker.h"
#include "tests/map_server/synthetic_submaps.h"

namespace rumi::testing {
using namespace rumi::map_server;

// Front, back, front, back, front: three quarters of a walk round the room, so that its end sees no place again. The
// back submaps cover the gaps between the front submaps.
class MapBuilderTest : public ::testing::Test {
 protected:
  static constexpr int64_t kSession = 7;
  const SubmapKey front1_{kSession, 1}, front2_{kSession, 2}, front3_{kSession, 3}, back1_{kSession, -1},
      back2_{kSession, -2};

  explicit MapBuilderTest(double drift_per_image = 0.001, const Pyramid& pyramid = {})
      : world_(make_room(1)), pyramid_(pyramid) {
    images_ = film(world_, walk_round(150, 0.75), {.pyramid = pyramid, .most_keypoints = 150, .every = 3});
    add(front1_, 0, 39, drift_per_image);
    add(back1_, 24, 69, 0);
    add(front2_, 54, 99, -drift_per_image);
    add(back2_, 84, 126, 0);
    add(front3_, 111, 149, drift_per_image);
  }

  void add(SubmapKey key, int first, int last, double drift_per_image) {
    SubmapRecipe recipe{.key = key, .first = first, .last = last};
    recipe.kind = key.id < 0 ? SubmapKind::kBack : SubmapKind::kFront;
    recipe.keyframe_every = 3;
    recipe.submap_from_world = random_gauge(static_cast<unsigned>(key.id + 10));
    recipe.pyramid = pyramid_;
    recipe.seed = static_cast<unsigned>(key.id + 20);
    recipe.wrong_observations = 0.02;
    recipe.wrong_landmarks = 0.03;
    if (drift_per_image != 0) recipe.distortion = drift(images_, first, drift_per_image);
    recipes_[key] = recipe;
    made_[key] = make_submap(world_, images_, recipe);
  }

  Submaps submaps(const std::vector<SubmapKey>& keys = {}) const {
    Submaps submaps;
    for (const auto& [key, made] : made_)
      if (keys.empty() || std::count(keys.begin(), keys.end(), key)) submaps[key] = &made.submap;
    return submaps;
  }

  size_t frames_of(const Placements& placements) const {
    size_t frames = 0;
    for (const auto& [key, placement] : placements) frames += made_.at(key).submap.frames.size();
    return frames;
  }

  static int image_of(int64_t utime_us) { return static_cast<int>((utime_us - 1'000'000) / 100'000); }

  // Returns the error of all frames of the placed submaps.
  PathError error(const Placements& placements) const {
    std::vector<Eigen::Vector3d> estimate, truth;
    for (const auto& [key, placement] : placements)
      for (const auto& [utime_us, frame] : made_.at(key).submap.frames) {
        estimate.push_back(placement.cam_from_map(made_.at(key).submap, frame).center());
        truth.push_back(images_[image_of(utime_us)].cam_from_world.center());
      }
    return path_error(estimate, truth);
  }

  static void print(const char* name, const BuiltMap& map, const PathError& error) {
    std::printf(
        "%-28s %zu submaps, ATE %.1f mm, worst %.1f mm; %d views, %d points, %d observations, rmse %.2f, %d outliers, "
        "%d fused\n",
        name, map.placements.size(), 1000 * error.rmse, 1000 * error.worst, map.report.views, map.report.points,
        map.report.observations, map.report.rmse, map.report.outliers, map.report.fused);
  }

  static bool finite(const Placements& placements) {
    for (const auto& [key, placement] : placements) {
      for (const auto& [utime_us, similarity] : placement.map_from_submap)
        if (!similarity.is_finite() || !(similarity.scale > 0)) return false;
      for (const auto& [id, position] : placement.landmarks)
        if (!position.allFinite()) return false;
    }
    return true;
  }

  World world_;
  Pyramid pyramid_;
  std::vector<Image> images_;
  std::map<SubmapKey, SubmapRecipe> recipes_;
  std::map<SubmapKey, SyntheticSubmap> made_;
};

}  // namespace rumi::testing
