// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/matching/tracks.h"

#include <gmock/gmock.h>

#include "tests/ruminator/test_window.h"

namespace rumi::ruminator {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Pair;

std::vector<WindowImage> images_with(const std::vector<int>& keypoints) {
  std::vector<WindowImage> images(keypoints.size());
  for (size_t i = 0; i < images.size(); ++i) images[i].keypoints.resize(keypoints[i]);
  return images;
}

TEST(Tracks, JoinMatchesOverSeveralImages) {
  const auto tracks = join_tracks(images_with({3, 3, 3, 3}),
                                  {{0, 1, {{2, 1}}}, {1, 3, {{1, 0}}}, {0, 2, {{0, 2}, {2, 0}}}, {2, 3, {{2, 2}}}});
  EXPECT_THAT(tracks, ElementsAre(ElementsAre(Pair(0, 0), Pair(2, 2), Pair(3, 2)),
                                  ElementsAre(Pair(0, 2), Pair(1, 1), Pair(2, 0), Pair(3, 0))));
}

TEST(Tracks, OfNothingAreNone) {
  EXPECT_THAT(join_tracks({}, {}), IsEmpty());
  EXPECT_THAT(join_tracks(images_with({0, 0}), {}), IsEmpty());
  EXPECT_THAT(join_tracks(images_with({5, 5}), {{0, 1, {}}}), IsEmpty());
}

// Keypoint 0 of image 2 is matched with both keypoints of image 0: the pairs with more matches prevail.
TEST(Tracks, AContradictionIsLeftToTheStrongestPairs) {
  const std::vector<WindowImage> images = images_with({4, 4, 4});
  const ImagePair weak{0, 2, {{1, 0}}}, first{0, 1, {{0, 0}, {2, 2}}}, second{1, 2, {{0, 0}, {3, 3}, {2, 2}}};
  const auto tracks = join_tracks(images, {weak, first, second});
  EXPECT_THAT(tracks,
              ElementsAre(ElementsAre(Pair(0, 0), Pair(1, 0), Pair(2, 0)),
                          ElementsAre(Pair(0, 2), Pair(1, 2), Pair(2, 2)), ElementsAre(Pair(1, 3), Pair(2, 3))));
}

TEST(Tracks, NeverHaveTwoKeypointsOfOneImageHoweverWrongTheMatches) {
  testing::TestWindow w = testing::sideways_window(8);
  testing::spoil(&w, 0.3, 0.2);
  w.pairs.push_back(w.pairs.front());  // so that the same pair occurs twice
  const auto tracks = join_tracks(w.images, w.pairs);
  ASSERT_GT(tracks.size(), 300U);
  std::set<std::pair<int, int>> used;
  for (const Track& track : tracks) {
    EXPECT_GE(track.size(), 2U);
    EXPECT_FALSE(testing::sees_an_image_twice(track));
    EXPECT_TRUE(std::is_sorted(track.begin(), track.end()));
    for (const auto& observation : track) EXPECT_TRUE(used.insert(observation).second);
  }
  EXPECT_TRUE(std::is_sorted(tracks.begin(), tracks.end()));
  EXPECT_EQ(join_tracks(w.images, w.pairs), tracks);
}

// Without wrong matches, each track is one point in all images that see it.
TEST(Tracks, AreThePoints) {
  const testing::TestWindow w = testing::sideways_window(5);
  for (const Track& track : join_tracks(w.images, w.pairs)) {
    const int point = w.point_of_keypoint[track[0].first][track[0].second];
    size_t seen = 0;
    for (const auto& of_keypoint : w.point_of_keypoint)
      seen += std::binary_search(of_keypoint.begin(), of_keypoint.end(), point);
    EXPECT_EQ(track.size(), seen);
    for (const auto& [image, keypoint] : track) EXPECT_EQ(w.point_of_keypoint[image][keypoint], point);
  }
}

}  // namespace
}  // namespace rumi::ruminator
