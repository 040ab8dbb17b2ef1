// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/matching/sift_matching.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <set>

#include "tests/ruminator/test_pictures.h"
#include "tests/ruminator/test_window.h"

namespace rumi::ruminator {
namespace {

const SE3 kFirst = SyntheticScene::pose(-0.15, 0, 0, 0.05),
          kSecond = SyntheticScene::pose(0.2, 0.05, -0.1, -0.08, 0.04);

SiftFeatures features_of(const SE3& pose, uint64_t picture = 1) {
  const Camera camera = testing::picture_camera();
  return extract_sift(testing::see_plane(testing::textured_picture(picture), camera, pose), camera);
}

double share_of_right(const SiftFeatures& a, const SiftFeatures& b, const IndexPairs& matches) {
  int right = 0;
  for (const auto& [i, j] : matches) {
    const Eigen::Vector2d expected =
        testing::over_the_plane(testing::picture_camera(), kFirst, kSecond, a.undistorted[i].cast<double>());
    right += (expected - b.undistorted[j].cast<double>()).norm() < 2;
  }
  return matches.empty() ? 0 : static_cast<double>(right) / static_cast<double>(matches.size());
}

TEST(MatchSift, FindsTheSamePlacesEachOnce) {
  const SiftFeatures a = features_of(kFirst), b = features_of(kSecond);
  const IndexPairs matches = match_sift(a, b);
  EXPECT_GT(matches.size(), 100U);
  EXPECT_GT(share_of_right(a, b, matches), 0.9);
  std::set<int> second;
  for (size_t k = 0; k < matches.size(); ++k) {
    if (k > 0) {
      EXPECT_LT(matches[k - 1].first, matches[k].first);
    }
    EXPECT_TRUE(second.insert(matches[k].second).second);
  }
  EXPECT_EQ(match_sift(a, b), matches);
}

TEST(MatchSift, OfAPictureWithItselfIsItself) {
  const SiftFeatures a = features_of(kFirst);
  const IndexPairs matches = match_sift(a, a);
  EXPECT_GT(matches.size(), 0.8 * static_cast<double>(a.size()));
  for (const auto& [i, j] : matches) EXPECT_EQ(a.descriptors[i], a.descriptors[j]);
}

TEST(MatchSift, LooksAtTheFirstOnlyInAPreview) {
  const SiftFeatures a = features_of(kFirst), b = features_of(kSecond);
  const IndexPairs preview = match_sift(a, b, 60);
  EXPECT_FALSE(preview.empty());
  for (const auto& [i, j] : preview) {
    EXPECT_LT(i, 60);
    EXPECT_LT(j, 60);
  }
}

TEST(MatchSift, OfOtherPicturesOrNothingFindsAsGoodAsNothing) {
  const SiftFeatures a = features_of(kFirst), other = features_of(kSecond, 2), nothing;
  EXPECT_LT(match_sift(a, other).size(), 0.1 * static_cast<double>(a.size()));
  EXPECT_TRUE(match_sift(a, nothing).empty());
  EXPECT_TRUE(match_sift(nothing, a).empty());
  EXPECT_TRUE(match_sift(nothing, nothing).empty());
}

// Makes descriptors, some of which are similar and some equal.
SiftFeatures alike(size_t count, unsigned seed) {
  std::mt19937 random(seed);
  SiftFeatures features;
  for (size_t i = 0; i < count; ++i) {
    std::mt19937 of_kind(static_cast<unsigned>(random() % 12));
    std::array<double, 128> histogram{};
    double squares = 0;
    for (double& bin : histogram) {
      bin = static_cast<double>(of_kind() % 100) + static_cast<double>(random() % 3 * (random() % 40));
      squares += bin * bin;
    }
    SiftDescriptor descriptor{};
    for (size_t k = 0; k < 128; ++k) descriptor[k] = static_cast<uint8_t>(512 * histogram[k] / std::sqrt(squares));
    features.descriptors.push_back(i % 9 == 8 ? features.descriptors[i - 5] : descriptor);
    features.undistorted.emplace_back(0, 0);
    features.scale_px.push_back(1);
  }
  return features;
}

// The reference, in double precision: both descriptors are each other's nearest, at most 0.7 apart, and at most 0.8
// times as far apart as the second nearest.
IndexPairs by_comparing_all(const SiftFeatures& a, const SiftFeatures& b) {
  const auto squared = [&](size_t i, size_t j) {
    double product = 0;
    for (size_t k = 0; k < 128; ++k) product += a.descriptors[i][k] * b.descriptors[j][k];
    return 2 - 2 * product / (512.0 * 512.0);
  };
  IndexPairs matches;
  for (size_t i = 0; i < a.size(); ++i) {
    double best = 9, second = 9;
    size_t at = 0;
    for (size_t j = 0; j < b.size(); ++j) {
      const double d = squared(i, j);
      second = std::min(second, std::max(best, d));
      if (d < best) at = j;
      best = std::min(best, d);
    }
    bool is_mutual = best <= 0.7 * 0.7 && best <= 0.8 * 0.8 * second;
    for (size_t other = 0; other < a.size() && is_mutual; ++other)
      is_mutual = other < i ? squared(other, at) > best : squared(other, at) >= best;
    if (is_mutual) matches.emplace_back(i, at);
  }
  return matches;
}

// For this many descriptors the C library allocates a memory block of its own, which begins 16 bytes after the start of
// a page. Vector code that needs a larger alignment must request it.
TEST(MatchSift, FindsTheSameAmongVeryMany) {
  const SiftFeatures a = alike(20, 1), few = alike(300, 2);
  SiftFeatures many = few;
  const SiftDescriptor nothing{};
  many.descriptors.resize(40'000, nothing);
  many.undistorted.resize(40'000, {0, 0});
  many.scale_px.resize(40'000, 1);
  EXPECT_EQ(match_sift(a, many), match_sift(a, few));
}

TEST(MatchSift, FindsWhatComparingAllFinds) {
  size_t found = 0;
  for (const auto& [x, y] : {std::pair{1, 1}, {1, 2}, {15, 17}, {16, 16}, {33, 48}, {60, 1}, {100, 90}}) {
    const SiftFeatures a = alike(x, 1), b = alike(y, 2);
    EXPECT_EQ(match_sift(a, b), by_comparing_all(a, b)) << x << " " << y;
    found += match_sift(a, b).size();
  }
  EXPECT_GT(found, 8U);
}

// If two candidates are equal, neither is distinct. A single one has no rival.
TEST(MatchSift, WantsADistinctBest) {
  SiftFeatures one = features_of(kFirst);
  one.undistorted.resize(1), one.scale_px.resize(1), one.descriptors.resize(1);
  EXPECT_EQ(match_sift(one, one), (IndexPairs{{0, 0}}));
  SiftFeatures twice = one;
  twice.undistorted.push_back({1, 1});
  twice.scale_px.push_back(twice.scale_px[0]);
  twice.descriptors.push_back(twice.descriptors[0]);
  twice.descriptors[1][0] ^= 1;
  SiftFeatures between = one;
  between.descriptors[0][1] ^= 8;
  EXPECT_TRUE(match_sift(between, twice).empty());
}

TEST(VerifyMatches, KeepsWhatOneMotionExplains) {
  const testing::TestWindow w = testing::sideways_window(2, 0.3);
  SiftFeatures a, b;
  a.undistorted = w.images[0].keypoints;
  b.undistorted = w.images[1].keypoints;
  testing::TestWindow spoiled = w;
  testing::spoil(&spoiled, 0.4, 0);
  const std::set<std::pair<int, int>> truth(w.pairs[0].matches.begin(), w.pairs[0].matches.end());
  const IndexPairs verified = verify_matches(w.camera, a, b, spoiled.pairs[0].matches);
  int right = 0, right_given = 0;
  for (const auto& match : verified) right += truth.contains(match);
  for (const auto& match : spoiled.pairs[0].matches) right_given += truth.contains(match);
  EXPECT_GT(right, 0.9 * right_given);
  EXPECT_GT(right, 0.93 * static_cast<double>(verified.size()));
  EXPECT_EQ(verify_matches(w.camera, a, b, spoiled.pairs[0].matches), verified);
}

// The limit is for the distance from both epipolar lines, whichever distance OpenCV compares with its threshold. With
// noise of 0.7 px in both images, some 70 % of the matches are within 1.5 px; with the Sampson error it would be 98 %.
TEST(VerifyMatches, ThresholdIsTheDistanceFromBothLines) {
  double kept = 0, given = 0;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const testing::TestWindow w = testing::sideways_window(2, 0);
    std::mt19937 random(seed);
    std::normal_distribution<float> noise(0, 0.7f);
    SiftFeatures a, b;
    for (const Eigen::Vector2f& pixel : w.images[0].keypoints)
      a.undistorted.push_back(pixel + Eigen::Vector2f(noise(random), noise(random)));
    for (const Eigen::Vector2f& pixel : w.images[1].keypoints)
      b.undistorted.push_back(pixel + Eigen::Vector2f(noise(random), noise(random)));
    given += static_cast<double>(w.pairs[0].matches.size());
    kept += static_cast<double>(verify_matches(w.camera, a, b, w.pairs[0].matches).size());
  }
  EXPECT_GT(kept, 0.6 * given);
  EXPECT_LT(kept, 0.85 * given);
}

TEST(VerifyMatches, RefusesWhatNoMotionExplains) {
  testing::TestWindow w = testing::sideways_window(2);
  SiftFeatures a, b;
  a.undistorted = w.images[0].keypoints;
  b.undistorted = w.images[1].keypoints;
  IndexPairs matches = w.pairs[0].matches;
  EXPECT_TRUE(verify_matches(w.camera, a, b, {}).empty());
  EXPECT_TRUE(verify_matches(w.camera, a, b, {matches.begin(), matches.begin() + 19}).empty());
  testing::spoil(&w, 1, 0);
  const IndexPairs& spoiled = w.pairs[0].matches;
  EXPECT_TRUE(verify_matches(w.camera, a, b, {spoiled.begin(), spoiled.begin() + 60}).empty());
}

TEST(VerifyMatches, SurvivesPointsThatCoincideOrAreNotFinite) {
  testing::TestWindow w = testing::sideways_window(2);
  SiftFeatures a, b;
  a.undistorted.assign(w.images[0].keypoints.size(), {100, 100});
  b.undistorted.assign(w.images[1].keypoints.size(), {120, 90});
  verify_matches(w.camera, a, b, w.pairs[0].matches);
  a.undistorted.assign(a.size(), {NAN, NAN});
  EXPECT_TRUE(verify_matches(w.camera, a, b, w.pairs[0].matches).empty());
}

}  // namespace
}  // namespace rumi::ruminator
