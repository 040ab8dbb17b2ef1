// SPDX-License-Identifier: BSD-3-Clause
// Submaps made of seeded noise (consistent, but no scene), the messages that would bring them, and comparison to the
// bit.
#pragma once

#include <gtest/gtest.h>

#include <random>

#include "lcmtypes/rumi/mask_t.hpp"
#include "lcmtypes/rumi/track_t.hpp"
#include "map_server/atlas/atlas.h"
#include "tests/support/temporary_folder.h"

namespace rumi::testing {
using namespace rumi::map_server;

Camera test_camera();

// Grows a submap step by step, as front_tracker would: every step raises the revision, adds a keyframe and a few
// frames, adds, moves and removes landmarks, and now and then removes a keyframe.
class SubmapMaker {
 public:
  SubmapMaker(SubmapKey key, uint32_t seed, int64_t first_utime_us = 1'000'000);
  void step();
  const Submap& submap() const { return submap_; }
  Submap& submap() { return submap_; }

 private:
  SE3 random_pose();
  int add_keyframe();
  void add_landmark();
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }

  Submap submap_;
  std::mt19937 random_;
  int64_t next_utime_us_;
  int next_keyframe_ = 0, next_landmark_ = 0;
};

// The submap as it is when `steps` are made.
Submap make_submap(SubmapKey key, uint32_t seed, int steps, int64_t first_utime_us = 1'000'000);

// Brings the atlas up to date with the submap, through the wire type.
void update_atlas(Atlas* atlas, const Submap& submap);

// Similarities at every keyframe but the last, and a place of their own for every third landmark; all differ with the
// seed.
Placement make_placement(const Submap& submap, uint32_t seed);

track_t make_track(int64_t utime_us, int64_t session, int8_t state, int32_t submap_id, bool is_keyframe = false);

// Of images of 64 x 48 pixels: the lowest `rows` never move.
StillMask make_mask(int64_t session, int64_t utime_us, int rows);
mask_t make_mask_message(int64_t stream, const StillMask& mask);

// Everything that is kept, bit for bit.
void expect_same(const Submap& a, const Submap& b);
void expect_same(const Placement& a, const Placement& b);
void expect_same(const Atlas& a, const Atlas& b);

}  // namespace rumi::testing
