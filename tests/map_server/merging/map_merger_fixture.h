// SPDX-License-Identifier: BSD-3-Clause
// A merger and its atlas, without the rest of map_server.
#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "map_server/merging/map_merger.h"
#include "tests/map_server/place_map.h"
#include "tests/map_server/synthetic_chain.h"

namespace rumi::testing {
using namespace rumi::map_server;

class MapMergerTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { chain_ = new Chain; }
  static void TearDownTestSuite() { delete std::exchange(chain_, nullptr); }
  MapMergerTest() { options_.thread = false; }

  void put(SubmapKey key) { testing::put(chain_->submap(key), &atlas_); }
  void change(SubmapKey key) {
    EXPECT_TRUE(atlas_.change_submap(key, [](Submap* submap) {
      ++submap->revision;
      return Result<>();
    }));
  }
  Submap broken(SubmapKey key, int64_t revision = 1) const {
    Submap submap = chain_->submap(key);
    break_submap(&submap);
    submap.revision = revision;
    return submap;
  }
  Submap good(SubmapKey key, int64_t revision) const {
    Submap submap = chain_->submap(key);
    submap.revision = revision;
    return submap;
  }
  // Ticks, as if somebody had requested all of the map, until nothing is left to do.
  void tick_until_idle(MapMerger* merger, double now_s) {
    merger->hurry();
    for (int i = 0; i < 100 && !merger->idle(atlas_); ++i) {
      if (options_.thread) {
        tick(merger, now_s);
        wait(merger, now_s);
      } else {
        tick(merger, now_s);
      }
      now_s += 1;
    }
    EXPECT_TRUE(merger->idle(atlas_));
  }
  // Ticks, and takes the result over as map_server does.
  std::optional<MergeResult> tick(MapMerger* merger, double now_s) {
    std::optional<MergeResult> result = merger->tick(static_cast<int64_t>(1e6 * now_s), atlas_);
    if (!result) return result;
    for (const auto& [key, submap] : result->culled) testing::put(*submap, &atlas_);
    if (!result->map.placements().empty()) testing::place_map(&atlas_, result->map.placements(), result->map.unmoved());
    return result;
  }
  // Ticks until the running build has ended.
  std::optional<MergeResult> wait(MapMerger* merger, double now_s) {
    for (int64_t i = 0; i < 1'000'000'000 && merger->running(); ++i) {
      if (auto result = tick(merger, now_s)) return result;
      std::this_thread::yield();
    }
    return std::nullopt;
  }

  // Returns an adjusted map whose last submap has only its first seven keyframes, and the rest of that submap.
  Growth begin_to_grow(MapMerger* merger) {
    Growth growth = grow(chain_->submap(Chain::kFront2), 7);
    put(Chain::kFront1);
    put(Chain::kBack1);
    testing::put(growth.early, &atlas_);
    merger->hurry();
    EXPECT_TRUE(tick(merger, 0));
    return growth;
  }

  inline static Chain* chain_ = nullptr;
  MergeOptions options_;
  Atlas atlas_;
};

}  // namespace rumi::testing
