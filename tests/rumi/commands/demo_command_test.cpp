// SPDX-License-Identifier: BSD-3-Clause
// Tests on the walk of `rumi demo` what Rumi is for: tracking is lost between two rooms, neither of which is seen from
// the other one. front_tracker goes on in a new submap, and only the rebuilt images of the loss join the two.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "map_server/store/map_store.h"
#include "tests/rumi/commands/end_to_end.h"

namespace rumi::tool {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class DemoTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    work_ = new TemporaryFolder;
    outcome_ = shell("$RUMI/rumi demo -o '" + work_->path().string() + "/demo'");
  }
  static void TearDownTestSuite() { delete work_; }
  void SetUp() override { ASSERT_EQ(outcome_.exit_code, 0) << outcome_.output; }

  static fs::path out() { return work_->path() / "demo"; }
  static map_server::Atlas map_of(const char* run) {
    return map_server::MapStore::open((out() / run / "map.db").string()).value().load().value();
  }
  // Returns the front submaps that have more than a moment of the walk.
  static std::vector<const map_server::AtlasSubmap*> large_front_submaps(const map_server::Atlas& atlas) {
    std::vector<const map_server::AtlasSubmap*> large;
    for (const auto& [key, owner] : atlas.submaps())
      if (owner.submap.kind == SubmapKind::kFront && owner.submap.frames.size() >= 100) large.push_back(&owner);
    return large;
  }
  static TemporaryFolder* work_;
  static Outcome outcome_;
};
TemporaryFolder* DemoTest::work_ = nullptr;
Outcome DemoTest::outcome_;

TEST_F(DemoTest, TheFrontAloneHasTwoSubmapsAndAMapOfOneRoom) {
  const map_server::Atlas atlas = map_of("front_alone");
  const auto fronts = large_front_submaps(atlas);
  ASSERT_EQ(fronts.size(), 2u) << outcome_.output;
  EXPECT_NE(fronts[0]->in_map, fronts[1]->in_map) << "nothing joins them";
  for (const auto& [key, owner] : atlas.submaps()) EXPECT_EQ(owner.submap.kind, SubmapKind::kFront);
  const auto figures = read_json_file(out() / "run.json")["front_alone"];
  EXPECT_LE(figures["tracked_frame_ratio"], 0.6);
  EXPECT_LE(figures["true_rate"], 0.6);
}

TEST_F(DemoTest, WhatWasLostIsRebuiltAndJoinsBothRooms) {
  const map_server::Atlas atlas = map_of("rumi");
  const auto fronts = large_front_submaps(atlas);
  ASSERT_EQ(fronts.size(), 2u) << outcome_.output;
  EXPECT_TRUE(fronts[0]->in_map && fronts[1]->in_map);
  // One back submap is joined to the front submaps of both rooms.
  const auto joined_to = [&](const map_server::AtlasSubmap& back, const map_server::AtlasSubmap& front) {
    return std::any_of(atlas.links().begin(), atlas.links().end(), [&](const map_server::Link& link) {
      const auto is = [](const SubmapKey& key, const map_server::AtlasSubmap& owner) {
        return key == owner.submap.key;
      };
      return link.accepted() && link.kind == map_server::Link::Kind::kSameImages &&
             ((is(link.a, back) && is(link.b, front)) || (is(link.b, back) && is(link.a, front)));
    });
  };
  const bool bridged = std::any_of(atlas.submaps().begin(), atlas.submaps().end(), [&](const auto& entry) {
    const map_server::AtlasSubmap& back = entry.second;
    return back.submap.kind == SubmapKind::kBack && back.in_map && joined_to(back, *fronts[0]) &&
           joined_to(back, *fronts[1]);
  });
  EXPECT_TRUE(bridged) << outcome_.output;
  EXPECT_GE(read_json_file(out() / "rumi" / "run.json")["windows"]["rebuilt"], 1);
  const auto figures = read_json_file(out() / "run.json")["rumi"];
  EXPECT_GE(figures["tracked_frame_ratio"], 0.95);
  EXPECT_GE(figures["true_rate"], 0.75);
}

TEST_F(DemoTest, EndsWithATableAStoryAndPictures) {
  for (const char* words :
       {"front alone", "frames with a pose in the one map", "Tracking was lost at", "became one map"})
    EXPECT_THAT(outcome_.output, HasSubstr(words));
  for (const char* file : {"rumi/trajectory.png", "rumi/window.png", "rumi/evaluation.png", "rumi/report.html",
                           "rumi/messages.lcm", "front_alone/trajectory.png", "sequence/groundtruth.txt"}) {
    EXPECT_TRUE(fs::exists(out() / file)) << file;
    EXPECT_THAT(outcome_.output, HasSubstr((out() / file).parent_path().string()));
  }
}

TEST(DemoCommand, SaysWhatIsWrong) {
  const TemporaryFolder work;
  const Outcome shortest = shell("$RUMI/rumi demo --seconds 2 -o '" + work.path().string() + "/d'");
  EXPECT_EQ(shortest.exit_code, 2);
  EXPECT_THAT(shortest.output, HasSubstr("seconds of the walk next-room is 2"));
  std::ofstream(work.path() / "thesis.txt") << "the only copy";
  const Outcome foreign = shell("$RUMI/rumi demo -o '" + work.path().string() + "'");
  EXPECT_EQ(foreign.exit_code, 1);
  EXPECT_THAT(foreign.output, HasSubstr("choose another folder"));
  EXPECT_TRUE(fs::exists(work.path() / "thesis.txt"));
  std::ofstream(work.path() / "run.json") << R"({"program": "rumi", "command": "replay"})";
  const Outcome other = shell("$RUMI/rumi demo -o '" + work.path().string() + "'");
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_THAT(other.output, HasSubstr("not of an earlier demo"));
  const Outcome setting = shell("$RUMI/rumi demo --set front_tracker.keypoint=5 -o '" + work.path().string() + "/d'");
  EXPECT_EQ(setting.exit_code, 2);
  EXPECT_THAT(setting.output, HasSubstr("front_tracker.keypoints"));
  EXPECT_FALSE(fs::exists(work.path() / "d")) << "before anything is rendered";
}

}  // namespace
}  // namespace rumi::tool
