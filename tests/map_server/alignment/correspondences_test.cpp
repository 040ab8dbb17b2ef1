// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/alignment/correspondences.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/map_server/synthetic_submaps.h"

namespace rumi::testing {
using namespace rumi::map_server;
namespace {

struct Seen {
  Eigen::Vector2f pixel;
  int landmark = kNone;
};

// Makes a submap with one keyframe for each image. Each landmark lies on the ray of the last pixel that sees it, at
// this depth.
Submap hand_made(const std::map<int64_t, std::vector<Seen>>& images, double depth = 2) {
  Submap submap;
  submap.camera = rumi::test_camera();
  submap.revision = 1;
  for (const auto& [utime_us, seen] : images) {
    const int id = static_cast<int>(submap.keyframes.size());
    Features features;
    for (const Seen& s : seen) {
      features.keypoints.push_back({s.pixel, 0, 0});
      const auto bits = [](float x) { return static_cast<uint64_t>(std::lround(1000 * x)); };
      features.descriptors.push_back({bits(s.pixel.x()), bits(s.pixel.y())});  // unlike those of all others
    }
    features.undistort(submap.camera);
    Keyframe& keyframe = submap.keyframes[id];
    keyframe.id = id;
    keyframe.utime_us = utime_us;
    keyframe.features = std::make_shared<Features>(features);
    keyframe.landmark_ids.assign(seen.size(), kNone);
    submap.frames.set({utime_us, id, SE3(), 1});
    for (size_t k = 0; k < seen.size(); ++k) {
      if (seen[k].landmark == kNone) continue;
      Landmark& landmark = submap.landmarks[seen[k].landmark];
      landmark.id = seen[k].landmark;
      landmark.position = depth * submap.camera.ray(features.undistorted[k]);
      submap.add_observation(landmark.id, id, static_cast<int>(k));
    }
  }
  return submap;
}

using Pairs = std::vector<std::pair<int, int>>;
Pairs landmark_pairs(const Correspondences& common) {
  Pairs pairs;
  for (const LandmarkMatch& m : common.landmarks) pairs.emplace_back(m.a, m.b);
  return pairs;
}

TEST(Correspondences, AreTheLandmarksAtTheSamePixel) {
  const Submap a = hand_made({{10, {{{100, 100}, 1}, {{200, 100}, kNone}, {{300, 100}, 2}, {{400, 100}, 3}}}});
  const Submap b = hand_made({{10, {{{300.4f, 100.3f}, 7}, {{100, 100}, 8}, {{200, 100}, 9}, {{402, 100}, 6}}}});
  const Correspondences common = find_correspondences(a, b, 1.0);
  ASSERT_EQ(common.keyframes.size(), 1u);
  EXPECT_EQ(common.keyframes[0].utime_us, 10);
  EXPECT_EQ(landmark_pairs(common), (Pairs{{1, 8}, {2, 7}}));
  EXPECT_EQ(common.landmarks[1].keypoint_a, 2);
  EXPECT_EQ(common.landmarks[1].keypoint_b, 0);
  EXPECT_EQ(landmark_pairs(find_correspondences(a, b, 2.5)), (Pairs{{1, 8}, {2, 7}, {3, 6}}));
}

TEST(Correspondences, AreTheSameKeypointsWhereverFrontTrackerMovedThem) {
  const std::map<int64_t, std::vector<Seen>> seen = {
      {10, {{{100, 100}, 1}, {{104, 100}, 2}, {{300, 100}, kNone}, {{400, 100}, 3}}}};
  const Submap b = hand_made(seen);
  Submap a = b;
  Features moved = *b.keyframe(0)->features;
  moved.move(0, {104, 100}, a.camera);  // to its neighbour's place
  moved.move(1, {107, 100}, a.camera);
  a.keyframe(0)->features = std::make_shared<Features>(moved);
  EXPECT_EQ(landmark_pairs(find_correspondences(a, b, 1.0)), (Pairs{{1, 1}, {2, 2}, {3, 3}}));
  // If the keypoints come from another detector or image, they are matched by distance.
  moved.keypoints[2].octave = 1;
  a.keyframe(0)->features = std::make_shared<Features>(moved);
  EXPECT_EQ(landmark_pairs(find_correspondences(a, b, 1.0)), (Pairs{{1, 2}, {3, 3}}));
}

TEST(Correspondences, AreEachOthersNearestAndNoKeypointIsUsedTwice) {
  // 200.4 is near 200.0, but nearer to 200.7; the nearest to 201.2 is 200.7 too, but that one is taken.
  const Submap a = hand_made({{10, {{{200, 100}, 1}, {{200.7f, 100}, 2}}}});
  const Submap b = hand_made({{10, {{{200.4f, 100}, 3}, {{201.2f, 100}, 4}}}});
  const Correspondences common = find_correspondences(a, b, 1.0);
  EXPECT_EQ(landmark_pairs(common), (Pairs{{2, 3}}));

  const World world = make_room(1);
  const auto images = film(world, walk_round(20, 0.2), {});
  const Submap front = make_submap(world, images, {.last = 19}).submap;
  const Submap back =
      make_submap(world, images, {.key = {1, -1}, .kind = SubmapKind::kBack, .last = 19, .seed = 2}).submap;
  const Correspondences found = find_correspondences(front, back, 1.0);
  EXPECT_GT(found.landmarks.size(), 500u);
  std::set<std::pair<int, int>> used_a, used_b;
  for (const LandmarkMatch& m : found.landmarks) {
    EXPECT_TRUE(used_a.insert({m.shared, m.keypoint_a}).second);
    EXPECT_TRUE(used_b.insert({m.shared, m.keypoint_b}).second);
    EXPECT_EQ(front.keyframe(found.keyframes[m.shared].a)->landmark_ids[m.keypoint_a], m.a);
    EXPECT_EQ(back.keyframe(found.keyframes[m.shared].b)->landmark_ids[m.keypoint_b], m.b);
  }
}

TEST(Correspondences, TheSameImageGivesTheSameLandmarksThroughAnyLens) {
  for (const Camera& camera : {rumi::test_camera(), test_fisheye()}) {
    const World world = make_room(3);
    const auto images = film(world, walk_round(16, 0.16), {.camera = camera});
    const auto front = make_submap(world, images, {.last = 15}, camera);
    const auto back = make_submap(world, images, {.key = {1, -1}, .last = 15, .keyframe_every = 1, .seed = 2}, camera);
    const Correspondences common = find_correspondences(front.submap, back.submap, 1.0);
    EXPECT_EQ(common.keyframes.size(), 6u);
    size_t right = 0;
    for (const LandmarkMatch& m : common.landmarks) right += front.point_of.at(m.a) == back.point_of.at(m.b);
    EXPECT_GT(right, 300u);
    EXPECT_GE(right, 0.98 * common.landmarks.size());
  }
}

TEST(Correspondences, FramesOfTheSameTimeAreListedAlsoWhereOneIsNoKeyframe) {
  const World world = make_room(4);
  const auto images = film(world, walk_round(30, 0.3), {});
  const Submap a = make_submap(world, images, {.first = 0, .last = 19, .keyframe_every = 5}).submap;
  const Submap b =
      make_submap(world, images, {.first = 10, .last = 29, .keyframe_every = 5, .keyframe_offset = 3}).submap;
  const Correspondences common = find_correspondences(a, b, 1.0);
  ASSERT_EQ(common.frames.size(), 10u);
  EXPECT_TRUE(std::is_sorted(common.frames.begin(), common.frames.end()));
  EXPECT_TRUE(common.keyframes.empty());
  EXPECT_TRUE(common.landmarks.empty());
}

TEST(Correspondences, NothingInCommon) {
  const Submap some = hand_made({{10, {{{100, 100}, 1}}}});
  const Submap later = hand_made({{11, {{{100, 100}, 1}}}});
  const Submap blind = hand_made({{10, {{{100, 100}, kNone}}}});
  for (const Submap& other : {Submap(), later}) {
    const Correspondences common = find_correspondences(some, other, 1.0);
    EXPECT_TRUE(common.frames.empty());
    EXPECT_TRUE(common.keyframes.empty());
  }
  const Correspondences common = find_correspondences(some, blind, 1.0);
  EXPECT_EQ(common.keyframes.size(), 1u);
  EXPECT_TRUE(common.landmarks.empty());
}

TEST(Correspondences, ImagesOfTwoStreamsAreNotTheSameHoweverMuchTheirTimesAre) {
  const Submap a = hand_made({{10, {{{100, 100}, 1}, {{200, 100}, 2}}}});
  Submap b = a;
  EXPECT_EQ(find_correspondences(a, b).landmarks.size(), 2);
  b.stream = 1;
  const Correspondences none = find_correspondences(a, b);
  EXPECT_TRUE(none.frames.empty() && none.keyframes.empty() && none.landmarks.empty());
}

TEST(Correspondences, AKeypointFarOutsideTheImageDoesNoHarm) {
  const Submap a = hand_made({{10, {{{-1e6f, 4e5f}, 1}, {{100, 100}, 2}}}});
  const Correspondences common = find_correspondences(a, a, 1.0);
  EXPECT_EQ(landmark_pairs(common), (Pairs{{1, 1}, {2, 2}}));
}

std::vector<Seen> row_of(int count) {
  std::vector<Seen> seen;
  for (int i = 0; i < count; ++i) seen.push_back({{10.f + 20 * static_cast<float>(i), 100}, i});
  return seen;
}

TEST(ScaleRatio, IsTheMedianOfTheDepthRatios) {
  const Submap a = hand_made({{10, row_of(20)}}, 2);
  Submap b = hand_made({{10, row_of(20)}}, 5);
  const Correspondences common = find_correspondences(a, b, 1.0);
  ScaleRatio ratio = scale_ratio(a, b, common, 0, 20);
  EXPECT_NEAR(ratio.log_b_over_a, std::log(2.5), 1e-9);
  EXPECT_NEAR(ratio.sigma, 0, 1e-9);
  EXPECT_NEAR(ratio.depth_b, 5, 1e-9);
  for (int i = 0; i < 9; ++i) b.landmark(i)->position *= 100;  // outliers, which the median ignores
  ratio = scale_ratio(a, b, common, 0, 20);
  EXPECT_NEAR(ratio.log_b_over_a, std::log(2.5), 1e-9);
}

TEST(ScaleRatio, KnowsItsError) {
  std::mt19937 rng(5);
  std::normal_distribution<double> normal(0, 0.1);
  const Submap a = hand_made({{10, row_of(30)}}, 2);
  double squared = 0, sigma = 0;
  constexpr int kRuns = 300;
  for (int run = 0; run < kRuns; ++run) {
    Submap b = hand_made({{10, row_of(30)}}, 2);
    for (auto& [id, landmark] : b.landmarks) landmark.position *= std::exp(normal(rng));
    const ScaleRatio ratio = scale_ratio(a, b, find_correspondences(a, b, 1.0), 0, 10);
    squared += ratio.log_b_over_a * ratio.log_b_over_a / kRuns;
    sigma += ratio.sigma / kRuns;
  }
  EXPECT_NEAR(sigma / std::sqrt(squared), 1, 0.2);
}

TEST(ScaleRatio, IsUnknownWithTooFewLandmarksInFront) {
  Submap a = hand_made({{10, row_of(20)}}, 2);
  const Submap b = hand_made({{10, row_of(20)}}, 2);
  const Correspondences common = find_correspondences(a, b, 1.0);
  EXPECT_TRUE(std::isinf(scale_ratio(a, b, common, 0, 21).sigma));
  EXPECT_TRUE(std::isfinite(scale_ratio(a, b, common, 0, 20).sigma));
  a.landmark(3)->position.z() *= -1;  // now behind the camera
  EXPECT_TRUE(std::isinf(scale_ratio(a, b, common, 0, 20).sigma));
  EXPECT_TRUE(std::isinf(scale_ratio(a, b, Correspondences{{10}, {{10, 0, 0}}, {}}, 0, 0).sigma));
}

TEST(ScaleRatio, NeverPoisonedByALandmarkThatIsNoNumber) {
  Submap a = hand_made({{10, row_of(20)}}, 2);
  const Submap b = hand_made({{10, row_of(20)}}, 5);
  const Correspondences common = find_correspondences(a, b, 1.0);
  a.landmark(3)->position.setConstant(NAN);
  a.landmark(4)->position.setConstant(INFINITY);
  const ScaleRatio ratio = scale_ratio(a, b, common, 0, 10);
  EXPECT_NEAR(ratio.log_b_over_a, std::log(2.5), 1e-9);
  EXPECT_TRUE(std::isfinite(ratio.sigma));
}

}  // namespace
}  // namespace rumi::testing
