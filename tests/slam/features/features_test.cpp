// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>
#include <random>

#include "slam/features/keyframe_index.h"
#include "slam/features/keypoint_grid.h"
#include "slam/features/keypoint_whitening.h"
#include "slam/features/matching.h"
#include "slam/features/orb_extractor.h"
#include "tests/slam/synthetic_scene.h"

namespace rumi {
namespace {

// Returns smoothed random blocks, which have corners of many sizes everywhere.
cv::Mat texture(int width, int height, unsigned seed) {
  cv::Mat image(height, width, CV_8U, cv::Scalar(120));
  cv::RNG rng(seed);
  for (int i = 0; i < 900; ++i) {
    const cv::Rect block(rng.uniform(0, width), rng.uniform(0, height), rng.uniform(5, 40), rng.uniform(5, 40));
    cv::rectangle(image, block, cv::Scalar(rng.uniform(0, 255)), cv::FILLED);
  }
  cv::GaussianBlur(image, image, {3, 3}, 0.8);
  return image;
}

TEST(OrbExtractor, IsEvenAndRepeatable) {
  const cv::Mat image = texture(640, 480, 1);
  OrbExtractor extractor({});
  const Features a = extractor.extract(image), b = extractor.extract(image);
  EXPECT_GT(a.size(), 900u);
  EXPECT_LE(a.size(), 1010u);
  ASSERT_EQ(a.size(), b.size());
  ASSERT_EQ(a.whitenings.size(), a.size());
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a.keypoints[i].pixel, b.keypoints[i].pixel);
    EXPECT_EQ(a.descriptors[i], b.descriptors[i]);
    EXPECT_EQ(a.whitenings[i], b.whitenings[i]);
  }
  int cells[4][4] = {};
  for (const Keypoint& k : a.keypoints) {
    ASSERT_TRUE(k.pixel.x() >= 0 && k.pixel.x() < 640 && k.pixel.y() >= 0 && k.pixel.y() < 480);
    ++cells[static_cast<int>(k.pixel.y() / 120)][static_cast<int>(k.pixel.x() / 160)];
  }
  for (const auto& row : cells)
    for (int count : row) EXPECT_GT(count, 20);
}

TEST(OrbExtractor, FindsTheSameCornersInATurnedAndShrunkImage) {
  const cv::Mat image = texture(640, 480, 2);
  const cv::Mat warp = cv::getRotationMatrix2D({320, 240}, 20, 0.8);
  cv::Mat turned;
  cv::warpAffine(image, turned, warp, image.size(), cv::INTER_AREA);
  OrbExtractor extractor({});
  Features a = extractor.extract(image), b = extractor.extract(turned);
  a.undistort(test_camera());
  b.undistort(test_camera());
  const std::vector<Match> matches = match_features(a, {}, b, {}, {});
  int right = 0;
  for (const Match& m : matches) {
    const Eigen::Vector2f p = a.keypoints[m.first].pixel, q = b.keypoints[m.second].pixel;
    const cv::Vec3d h(p.x(), p.y(), 1);
    const double x = cv::Mat(warp.row(0)).dot(cv::Mat(h).t()), y = cv::Mat(warp.row(1)).dot(cv::Mat(h).t());
    right += std::hypot(x - q.x(), y - q.y()) < 3;
  }
  EXPECT_GT(matches.size(), 150u);
  EXPECT_GT(right, 0.95 * static_cast<double>(matches.size()));
}

TEST(OrbExtractor, WhatItSawBeforeChangesNothing) {
  OrbExtractor used({});
  for (const double contrast : {1.0, 0.1, 0.1, 0.3, 0.2, 1.0, 0.0, 0.15, 1.0, 1.0}) {
    cv::Mat image;
    texture(640, 480, 3).convertTo(image, CV_8U, contrast, 60);
    const Features expected = OrbExtractor({}).extract(image), features = used.extract(image);
    ASSERT_EQ(features.size(), expected.size()) << "contrast " << contrast;
    EXPECT_EQ(features.descriptors, expected.descriptors);
    for (size_t i = 0; i < features.size(); ++i) EXPECT_EQ(features.keypoints[i].pixel, expected.keypoints[i].pixel);
  }
}

TEST(OrbExtractor, EmptyAndSaturatedAndTinyImagesGiveNothing) {
  OrbExtractor extractor({});
  EXPECT_EQ(extractor.extract(cv::Mat(480, 640, CV_8U, cv::Scalar(0))).size(), 0u);
  EXPECT_EQ(extractor.extract(cv::Mat(480, 640, CV_8U, cv::Scalar(255))).size(), 0u);
  EXPECT_EQ(extractor.extract(cv::Mat(16, 16, CV_8U, cv::Scalar(90))).size(), 0u);
}

// Tests a straight edge, a corner, and an image without either.
TEST(KeypointWhitening, KnowsEdgesFromCorners) {
  for (double angle_deg = 0; angle_deg < 180; angle_deg += 15) {
    const Eigen::Vector2d along(std::cos(angle_deg * M_PI / 180), std::sin(angle_deg * M_PI / 180));
    const Eigen::Vector2d across(-along.y(), along.x());
    cv::Mat edge(40, 40, CV_8U), corner(40, 40, CV_8U);
    for (int y = 0; y < 40; ++y)
      for (int x = 0; x < 40; ++x) {
        const Eigen::Vector2d p(x - 20, y - 20);
        edge.at<uchar>(y, x) = across.dot(p) > 0.3 ? 200 : 60;
        corner.at<uchar>(y, x) = across.dot(p) > 0 && along.dot(p) > 0 ? 200 : 60;
      }
    cv::GaussianBlur(edge, edge, {9, 9}, 2);
    cv::GaussianBlur(corner, corner, {9, 9}, 1);
    const Eigen::Matrix2d w = keypoint_whitening(edge, {20, 20}).cast<double>();
    EXPECT_NEAR((w * across - across).norm(), 0, 0.04) << angle_deg;
    EXPECT_NEAR((w * along - along / 6).norm(), 0, 0.04) << angle_deg;
    EXPECT_TRUE(keypoint_whitening(corner, {20, 20}).isIdentity()) << angle_deg;
  }
  EXPECT_TRUE(keypoint_whitening(cv::Mat(40, 40, CV_8U, cv::Scalar(90)), {20, 20}).isIdentity());
}

TEST(KeypointGrid, FindsAllThatLinearSearchFinds) {
  SyntheticScene scene(1);
  std::vector<Eigen::Vector2f> points;
  for (int i = 0; i < 500; ++i) points.emplace_back(scene.uniform(-30, 670), scene.uniform(-30, 510));
  const KeypointGrid grid(points, test_camera());
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector2f center(scene.uniform(-50, 690), scene.uniform(-50, 530));
    const float radius = static_cast<float>(scene.uniform(1, 60));
    int found = 0, expected = 0;
    grid.for_each_near(center, radius, [&](int j) { found += (points[j] - center).norm() <= radius; });
    for (const auto& p : points) expected += (p - center).norm() <= radius;
    EXPECT_EQ(found, expected);
  }
  KeypointGrid({}, test_camera()).for_each_near({5, 5}, 100, [](int) { FAIL(); });
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const std::vector<Eigen::Vector2f> nowhere = {{1e30F, -1e30F}, {-kInfinity, std::nanf("")}};
  const KeypointGrid far(nowhere, test_camera());
  int all = 0;
  far.for_each_near({0, 0}, kInfinity, [&all](int) { ++all; });
  EXPECT_EQ(all, 2) << "what is nowhere is in a cell all the same";
}

Descriptor random_descriptor(std::mt19937_64& rng) { return {rng(), rng(), rng(), rng()}; }

Descriptor disturbed(Descriptor d, std::mt19937_64& rng, int bits) {
  for (int i = 0; i < bits; ++i) {
    const int bit = static_cast<int>(rng() % 256);
    d[bit / 64] ^= uint64_t{1} << (bit % 64);
  }
  return d;
}

TEST(KeyframeIndex, RecallsThePlaceAmongMany) {
  std::mt19937_64 rng(5);
  KeyframeIndex index;
  std::vector<std::vector<Descriptor>> places;
  for (int place = 0; place < 300; ++place) {
    std::vector<Descriptor> descriptors(300);
    for (Descriptor& d : descriptors) d = random_descriptor(rng);
    index.add(place, descriptors);
    places.push_back(std::move(descriptors));
  }
  int first = 0;
  for (int place = 0; place < 300; ++place) {
    // The query has 90 of the place's 300 descriptors, with up to 30 of 256 bits changed, among 700 others.
    std::vector<Descriptor> query;
    for (int i = 0; i < 90; ++i) query.push_back(disturbed(places[place][i], rng, 30));
    for (int i = 0; i < 700; ++i) query.push_back(random_descriptor(rng));
    const auto candidates = index.query(query, 5);
    ASSERT_FALSE(candidates.empty());
    first += candidates.front().keyframe == place;
  }
  EXPECT_GE(first, 295);
  index.remove(7);
  EXPECT_EQ(index.size(), 299u);
  for (const auto& c : index.query(places[7], 300)) EXPECT_NE(c.keyframe, 7);
  index.remove_if([](int64_t place) { return place >= 100; });
  EXPECT_EQ(index.size(), 99u);
  for (const auto& c : index.query(places[200], 300)) EXPECT_LT(c.keyframe, 100);
  EXPECT_EQ(index.query(places[8], 1).front().keyframe, 8) << "what stays is found as before";
  EXPECT_TRUE(KeyframeIndex().query(places[7], 5).empty());
  EXPECT_TRUE(index.query({}, 5).empty());
}

TEST(KeyframeIndex, AnswersLikeAFreshOneAfterKeyframesHaveComeAndGone) {
  std::mt19937_64 rng(6);
  std::vector<std::vector<Descriptor>> places(60, std::vector<Descriptor>(40));
  for (auto& descriptors : places) {
    for (Descriptor& d : descriptors) d = random_descriptor(rng);
    descriptors.back() = descriptors.front();  // the keyframe has a word twice
    descriptors[1] = places[0][1];             // a word that all keyframes have
  }
  KeyframeIndex index;
  for (int round = 0; round < 5; ++round)
    for (int place = 0; place < 60; ++place) {
      if (place % 4 == round) index.remove(place);
      if (place % 3 != round) index.add(place, places[(place + 4 - round) % 60]);
    }
  KeyframeIndex fresh;
  for (int place = 0; place < 60; ++place) fresh.add(place, places[place]);
  ASSERT_EQ(index.size(), fresh.size());
  for (const auto& query : places) {
    const auto found = index.query(query, 60), wanted = fresh.query(query, 60);
    ASSERT_EQ(found.size(), wanted.size());
    for (size_t i = 0; i < wanted.size(); ++i) {
      EXPECT_EQ(found[i].keyframe, wanted[i].keyframe);
      EXPECT_EQ(found[i].score, wanted[i].score);
    }
  }
}

}  // namespace
}  // namespace rumi
