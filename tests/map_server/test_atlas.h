// SPDX-License-Identifier: BSD-3-Clause
// Submaps of random numbers (consistent, but of no scene), messages about them, and bit-by-bit comparisons.
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

// Grows a submap step by step, like front_tracker. Each step raises the revision, adds a keyframe and a few frames,
// adds, moves and removes landmarks, and sometimes removes a keyframe.
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

// Returns the submap after `steps` steps.
Submap make_submap(SubmapKey key, uint32_t seed, int steps, int64_t first_utime_us = 1'000'000);

// Updates the atlas with the submap by way of the message.
void update_atlas(Atlas* atlas, const Submap& submap);

// Returns similarities at all keyframes but the last, and positions for every third landmark. Another seed gives other
// numbers.
Placement make_placement(const Submap& submap, uint32_t seed);

track_t make_track(int64_t utime_us, int64_t session, int8_t state, int32_t submap_id, bool is_keyframe = false);

// Returns a mask for images of 64 x 48 pixels, of which the lowest `rows` never move.
StillMask make_mask(int64_t session, int64_t utime_us, int rows);
mask_t make_mask_message(int64_t stream, const StillMask& mask);

// Compares everything that is stored, bit by bit.
void expect_same(const Submap& a, const Submap& b);
void expect_same(const Placement& a, const Placement& b);
void expect_same(const Atlas& a, const Atlas& b);

}  // namespace rumi::testing
