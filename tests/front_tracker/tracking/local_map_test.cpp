// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/tracking/local_map.h"

#include <gtest/gtest.h>

namespace rumi::front_tracker {
namespace {

// Returns a submap in which keyframe k observes the landmarks k, k + 1 and k + 2.
Submap chain(int keyframes) {
  Submap map;
  for (int id = 0; id < keyframes + 2; ++id) map.landmarks[id].id = id;
  for (int k = 0; k < keyframes; ++k) {
    Keyframe& kf = map.keyframes[k];
    kf.id = k;
    kf.landmark_ids.assign(3, kNone);
    for (int i = 0; i < 3; ++i) map.add_observation(k + i, k, i);
  }
  return map;
}

std::vector<int> ids(const LocalMap& local) {
  std::vector<int> ids;
  for (const Landmark* lm : local.landmarks) ids.push_back(lm->id);
  return ids;
}

TEST(LocalMap, IsWhatTheKeyframesAroundSeeBesideWhatIsMatched) {
  const Submap map = chain(10);
  Frame frame;
  frame.landmark_ids = {4, kNone, 5, 6};
  const LocalMap one = local_map(map, frame, 1);
  EXPECT_EQ(one.reference_keyframe, 4);
  EXPECT_EQ(ids(one), std::vector<int>());
  EXPECT_EQ(ids(local_map(map, frame, 3)), std::vector<int>({3, 7})) << "keyframes 3, 4 and 5";
  EXPECT_EQ(ids(local_map(map, frame, 5)), std::vector<int>({2, 3, 7, 8})) << "2 to 6";
}

TEST(LocalMap, IsNothingWhereNothingIsShared) {
  Frame frame;
  frame.reference_keyframe = 3;
  frame.landmark_ids = {kNone};
  const LocalMap none = local_map(chain(5), frame, 10);
  EXPECT_EQ(none.reference_keyframe, 3) << "as it was";
  EXPECT_TRUE(none.landmarks.empty());
}

}  // namespace
}  // namespace rumi::front_tracker
