// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/matching/window_matches.h"

#include <gmock/gmock.h>

#include "tests/ruminator/test_pictures.h"
#include "tests/ruminator/test_window.h"

namespace rumi::ruminator {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;

const std::atomic<bool> kNever = false;

// Images 0, 1, 2 and 5 show one wall, 3 and 4 another.
std::vector<SiftFeatures> pictures() {
  std::vector<SiftFeatures> features;
  const Camera camera = testing::picture_camera();
  for (int i = 0; i < 6; ++i) {
    const cv::Mat wall = testing::textured_picture(i == 3 || i == 4 ? 2 : 1);
    features.push_back(
        extract_sift(testing::see_plane(wall, camera, SyntheticScene::pose(0.06 * i, 0.02 * i, 0)), camera, 300));
  }
  return features;
}

std::vector<std::pair<int, int>> ends(const std::vector<ImagePair>& pairs) {
  std::vector<std::pair<int, int>> ends;
  for (const ImagePair& pair : pairs) ends.emplace_back(pair.first, pair.second);
  return ends;
}

TEST(MatchWindow, FindsThePairsInOrder) {
  std::vector<double> fractions;
  const auto progress = [&](double fraction) { fractions.push_back(fraction); };
  for (const int near : {1, 10}) {
    const auto pairs = match_window(testing::picture_camera(), pictures(), {near}, progress, kNever);
    EXPECT_THAT(ends(pairs), ElementsAre(std::pair(0, 1), std::pair(0, 2), std::pair(0, 5), std::pair(1, 2),
                                         std::pair(1, 5), std::pair(2, 5), std::pair(3, 4)))
        << near;
    for (const ImagePair& pair : pairs) EXPECT_GE(pair.matches.size(), 15U);
  }
  ASSERT_FALSE(fractions.empty());
  for (const double fraction : fractions) EXPECT_TRUE(fraction >= 0 && fraction <= 1) << fraction;
  EXPECT_EQ(fractions.back(), 1);
}

TEST(MatchWindow, SkipsFarPairsWithoutAPreview) {
  int looked_at = 0;
  const auto count = [&looked_at](double) { ++looked_at; };
  match_window(testing::picture_camera(), pictures(), {.near = 1}, count, kNever);
  EXPECT_EQ(looked_at, 9) << "five pairs of neighbours, and four of the other ten";
  const auto pairs = match_window(testing::picture_camera(), pictures(), {.near = 1, .far = 0}, count, kNever);
  EXPECT_THAT(ends(pairs), ElementsAre(std::pair(0, 1), std::pair(1, 2), std::pair(3, 4)));
}

TEST(MatchWindow, StopsWhenItIsToldTo) {
  std::atomic<bool> cancel = true;
  int calls = 0;
  const auto progress = [&](double) {
    ++calls;
    cancel = true;
  };
  EXPECT_TRUE(match_window(testing::picture_camera(), pictures(), {}, progress, cancel).empty());
  cancel = false;
  calls = 0;
  EXPECT_THAT(ends(match_window(testing::picture_camera(), pictures(), {}, progress, cancel)),
              ElementsAre(std::pair(0, 1)));
  EXPECT_EQ(calls, 1);
}

TEST(MatchWindow, OfNothingIsNothing) {
  const auto none = [](double) {};
  EXPECT_TRUE(match_window(testing::picture_camera(), {}, {}, none, kNever).empty());
  EXPECT_TRUE(match_window(testing::picture_camera(), {{}}, {}, none, kNever).empty());
  EXPECT_TRUE(match_window(testing::picture_camera(), {{}, {}, {}}, {}, none, kNever).empty());
}

struct PairOfImages {
  std::vector<SiftFeatures> features;
  ImagePair pair;
};

PairOfImages see(const SE3& first, const SE3& second, double noise_px) {
  const testing::TestWindow w = testing::make_window({first, second}, SyntheticScene(7).cloud(400), noise_px);
  PairOfImages p{std::vector<SiftFeatures>(2), w.pairs.at(0)};
  for (int i = 0; i < 2; ++i) p.features[i].undistorted = w.images[i].keypoints;
  return p;
}

TEST(Parallax, OfATurnIsTheNoise) {
  const PairOfImages p = see(SyntheticScene::pose(0, 0, 0), SyntheticScene::pose(0, 0, 0, 0.3, 0.05), 0.7);
  EXPECT_LT(parallax_px(test_camera(), p.features, p.pair), 1.5);
  const PairOfImages exact = see(SyntheticScene::pose(0, 0, 0), SyntheticScene::pose(0, 0, 0, 0.3, 0.05), 0);
  EXPECT_LT(parallax_px(test_camera(), exact.features, exact.pair), 0.01);
}

TEST(Parallax, OfAStepIsWhatTheStepMoves) {
  // A step of 0.2 moves points at depths of 2 to 8 by 52 to 13 px; a rotation explains the mean of that.
  const PairOfImages p = see(SyntheticScene::pose(0, 0, 0), SyntheticScene::pose(0.2, 0, 0, 0.3, 0.05), 0.7);
  EXPECT_GT(parallax_px(test_camera(), p.features, p.pair), 3);
  EXPECT_LT(parallax_px(test_camera(), p.features, p.pair), 20);
}

TEST(Parallax, WithoutMatchesIsNone) {
  PairOfImages p = see(SyntheticScene::pose(0, 0, 0), SyntheticScene::pose(0.2, 0, 0), 0);
  p.pair.matches.clear();
  EXPECT_EQ(parallax_px(test_camera(), p.features, p.pair), 0);
}

ImagePair pair_of(int first, int second, int matches) {
  return {first, second, std::vector<std::pair<int, int>>(matches)};
}

TEST(ConnectedImages, AreNumberedFromTheLargestGroup) {
  EXPECT_THAT(connected_images(7, {pair_of(0, 5, 20), pair_of(2, 3, 20), pair_of(3, 6, 20), pair_of(0, 1, 19)}, 20),
              ElementsAre(1, 2, 0, 0, 3, 1, 0));
}

TEST(ConnectedImages, WithoutPairsAreAlone) {
  EXPECT_THAT(connected_images(3, {}, 1), ElementsAre(0, 1, 2));
  EXPECT_TRUE(connected_images(0, {}, 1).empty());
}

TEST(ConnectedImages, AreOneGroupOverAnyDetour) {
  std::vector<ImagePair> pairs;
  for (int i = 99; i > 0; --i) pairs.push_back(pair_of(i - 1, i, 30));
  EXPECT_THAT(connected_images(100, pairs, 30), Each(0));
}

}  // namespace
}  // namespace rumi::ruminator
