// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/run/again.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <set>

#include "tests/map_server/place_map.h"
#include "tests/map_server/test_atlas.h"

namespace rumi::tool {
namespace {

using map_server::Atlas;
using map_server::FrameRecord;
using ruminator::WindowCandidate;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr int64_t kSession = 7;

// Submap 1 is the map, submap 2 is not in it; three frames before the first one and two between them have no pose.
class FindIslands : public ::testing::Test {
 protected:
  FindIslands() {
    testing::update_atlas(&atlas_, in_map_);
    testing::update_atlas(&atlas_, outside_);
    testing::place_map(&atlas_, {{in_map_.key, testing::make_placement(in_map_, 1)}});
    for (const int64_t utime_us : {100'000, 200'000, 300'000, 4'000'000, 4'100'000})
      atlas_.record_frame({utime_us, 0}, {.session = kSession, .state = TrackingState::kLost});
    for (const Submap* submap : {&in_map_, &outside_})
      for (const auto& [utime_us, frame] : submap->frames)
        atlas_.record_frame({utime_us, 0},
                            {.session = kSession, .state = TrackingState::kTracking, .submap_id = submap->key.id});
  }
  std::set<int64_t> utimes_of(const Islands& islands, int island) const {
    std::set<int64_t> utimes_us;
    for (const WindowCandidate& c : islands.candidates)
      if (c.island == island) utimes_us.insert(c.sample.utime_us);
    return utimes_us;
  }

  const Submap in_map_ = testing::make_submap({kSession, 1}, 1, 10, 1'000'000);
  const Submap outside_ = testing::make_submap({kSession, 2}, 2, 10, 6'000'000);
  Atlas atlas_;
};

TEST_F(FindIslands, AreSubmapsOutsideTheMapAndRowsOfFramesWithoutPoses) {
  const Islands islands = find_islands(atlas_, kSession, 0);
  ASSERT_EQ(islands.all.size(), 3u);
  EXPECT_EQ(islands.frames, static_cast<int64_t>(5 + outside_.frames.size()));
  EXPECT_THAT(utimes_of(islands, 0), ElementsAre(100'000, 200'000, 300'000));
  EXPECT_THAT(utimes_of(islands, 1), ElementsAre(4'000'000, 4'100'000));
  EXPECT_EQ(islands.all[2].frames, static_cast<int64_t>(outside_.frames.size()));
  EXPECT_EQ(utimes_of(islands, 2).size(), outside_.frames.size());
  EXPECT_TRUE(std::is_sorted(islands.candidates.begin(), islands.candidates.end(),
                             [](const auto& a, const auto& b) { return a.sample.utime_us < b.sample.utime_us; }));
}

TEST_F(FindIslands, AllFramesOfASmallMapAreCandidates) {
  std::set<int64_t> frames, keyframes;
  for (const auto& [utime_us, frame] : in_map_.frames) frames.insert(utime_us);
  for (const auto& [id, keyframe] : in_map_.keyframes) keyframes.insert(keyframe.utime_us);
  const Islands islands = find_islands(atlas_, kSession, 0);
  EXPECT_EQ(utimes_of(islands, WindowCandidate::kInMap), frames);
  for (const WindowCandidate& c : islands.candidates)
    if (c.island == WindowCandidate::kInMap)
      EXPECT_EQ(c.sample.is_keyframe, keyframes.contains(c.sample.utime_us)) << c.sample.utime_us;
}

TEST_F(FindIslands, SamplesHaveThePosesOfTheMapOrOfTheirFrontSubmap) {
  for (const WindowCandidate& c : find_islands(atlas_, kSession, 0).candidates) {
    const int64_t t = c.sample.utime_us;
    EXPECT_EQ(c.sample.submap_id, in_map_.frame(t) ? ruminator::kMapFrame : outside_.frame(t) ? 2 : kNoSubmap) << t;
  }
}

TEST_F(FindIslands, OtherSessionsAndStreamsAreNotLookedAt) {
  EXPECT_THAT(find_islands(atlas_, kSession + 1, 0).all, IsEmpty());
  EXPECT_THAT(find_islands(atlas_, kSession, 5).all, IsEmpty());
}

}  // namespace
}  // namespace rumi::tool
