// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/mapping/own_motion.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "slam/features/pyramid.h"
#include "tests/slam/synthetic_scene.h"

namespace rumi::front_tracker {
namespace {

using Pixels = std::vector<Eigen::Vector2f>;

// Keyframes of a camera that moves to the right, and one thing that they may have seen: keypoint 0 and, if it is seen
// more than once in an image, those after it.
class OwnMotion : public ::testing::Test {
 protected:
  OwnMotion() {
    submap_.map.camera = test_camera();
    submap_.octave_scales = Pyramid().scales();
  }

  static SE3 pose(int i) { return SyntheticScene::pose(0.05 * i, 0, 0); }
  Eigen::Vector2f projection(int i) const {
    return submap_.map.camera.project_undistorted(pose(i) * point_).cast<float>();
  }

  void add_keyframe(const Pixels& seen_at) {
    const auto i = static_cast<int>(submap_.map.keyframes.size());
    Features features;
    for (const Eigen::Vector2f& pixel : seen_at) add(pixel, thing_, 4, &features);
    for (int k = 0; k < 50; ++k) {  // of the world
      const auto x = static_cast<float>(scene_.uniform(5, 630)), y = static_cast<float>(scene_.uniform(5, 470));
      add({x, y}, {rng_(), rng_(), rng_(), rng_()}, 0, &features);
    }
    Frame frame = make_frame(100'000 * (i + 1), std::move(features), submap_.map.camera);
    frame.cam_from_submap = pose(i);
    submap_.add_keyframe(&frame);
  }
  // So many bits of it are wrong.
  void add(const Eigen::Vector2f& pixel, Descriptor descriptor, int wrong, Features* features) {
    for (int bit = 0; bit < wrong; ++bit) descriptor[(rng_() >> 8) % 4] ^= uint64_t{1} << (rng_() >> 8) % 64;
    features->keypoints.push_back({pixel, 0, 0});
    features->descriptors.push_back(descriptor);
  }
  // The point is made of what the newest keyframe and the one before saw first.
  bool is_seen_elsewhere() const {
    const int newest = submap_.map.keyframes.rbegin()->first;
    return front_tracker::is_seen_elsewhere(submap_, point_, {*submap_.map.keyframe(newest), 0},
                                            {*submap_.map.keyframe(newest - 1), 0});
  }

  FrontSubmap submap_;
  SyntheticScene scene_{1};
  std::mt19937_64 rng_{2};
  const Descriptor thing_{rng_(), rng_(), rng_(), rng_()};
  const Eigen::Vector3d point_{0.1, 0.05, 2};
  const Eigen::Vector2f apart_{0, 30};  // from where the point should be
};

TEST_F(OwnMotion, AStillPointIsWhereItShouldBe) {
  for (int i = 0; i < 5; ++i) add_keyframe({projection(i)});
  EXPECT_FALSE(is_seen_elsewhere());
}

TEST_F(OwnMotion, WhatOthersSawElsewhereMoves) {
  for (int i = 0; i < 3; ++i) add_keyframe({projection(3) + apart_ * (3.F - static_cast<float>(i)) / 3.F});
  for (int i = 3; i < 5; ++i) add_keyframe({projection(i)});
  EXPECT_TRUE(is_seen_elsewhere());
}

TEST_F(OwnMotion, OneThatSawItElsewhereIsEnoughIfNoneSawItThere) {
  add_keyframe({projection(1) + apart_});
  for (int i = 1; i < 3; ++i) add_keyframe({projection(i)});
  EXPECT_TRUE(is_seen_elsewhere());
}

TEST_F(OwnMotion, TwinsOfWhichEitherMayBeItTellNothing) {
  const Eigen::Vector2f aside(-25, 0);
  for (int i = 0; i < 3; ++i) add_keyframe({projection(i) + apart_, projection(i) + aside});
  for (int i = 3; i < 5; ++i) add_keyframe({projection(i)});
  EXPECT_FALSE(is_seen_elsewhere());
}

// Of one corner there may be two keypoints, in two levels of the pyramid.
TEST_F(OwnMotion, TwinsInOnePlaceAreOne) {
  for (int i = 0; i < 3; ++i) add_keyframe({projection(3) + apart_, projection(3) + apart_ + Eigen::Vector2f(1, 1)});
  for (int i = 3; i < 5; ++i) add_keyframe({projection(i)});
  EXPECT_TRUE(is_seen_elsewhere());
}

TEST_F(OwnMotion, ATwinBesideThePointItselfIsAnother) {
  for (int i = 0; i < 3; ++i) add_keyframe({projection(i) + apart_, projection(i)});
  for (int i = 3; i < 5; ++i) add_keyframe({projection(i)});
  EXPECT_FALSE(is_seen_elsewhere());
}

TEST_F(OwnMotion, WhatOthersDidNotSeeMayBeStill) {
  for (int i = 0; i < 3; ++i) add_keyframe({});
  for (int i = 3; i < 5; ++i) add_keyframe({projection(i)});
  EXPECT_FALSE(is_seen_elsewhere());
}

TEST_F(OwnMotion, FarAwayItIsNotLookedFor) {
  for (int i = 0; i < 3; ++i) add_keyframe({projection(3) + 5 * apart_});
  for (int i = 3; i < 5; ++i) add_keyframe({projection(i)});
  EXPECT_FALSE(is_seen_elsewhere());
}

TEST_F(OwnMotion, AsManyHereAsThereIsNotElsewhere) {
  for (int i = 0; i < 4; ++i) add_keyframe({projection(i) + (i % 2 == 0 ? apart_ : Eigen::Vector2f(0, 0))});
  for (int i = 4; i < 6; ++i) add_keyframe({projection(i)});
  EXPECT_FALSE(is_seen_elsewhere());
}

TEST_F(OwnMotion, OnlyTheLatestAreAsked) {
  for (int i = 0; i < 6; ++i) add_keyframe({projection(i) + apart_});  // long ago
  for (int i = 6; i < 12; ++i) add_keyframe({projection(i)});
  EXPECT_FALSE(is_seen_elsewhere());
}

TEST_F(OwnMotion, TwoKeyframesHaveNoneToAsk) {
  for (int i = 0; i < 2; ++i) add_keyframe({projection(i)});
  EXPECT_FALSE(is_seen_elsewhere());
}

}  // namespace
}  // namespace rumi::front_tracker
