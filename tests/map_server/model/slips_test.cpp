// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/model/slips.h"

#include <gtest/gtest.h>

#include <cmath>

#include "map_server/model/map_graph.h"
#include "tests/map_server/synthetic_submaps.h"

namespace rumi::testing {
using namespace rumi::map_server;
namespace {

// A submap that goes round the room and sees the place where it began once more. On the way, between the keyframes
// kSlip and kSlip + 1, a quarter of its scale slips while the camera turns 5 degrees, and few landmarks are seen from
// both sides.
class SlipsTest : public ::testing::Test {
 protected:
  static constexpr int kImages = 180, kEvery = 3, kSlip = 35, kLoop = 50;  // kLoop: keyframes of a turn round the room
  static constexpr SubmapKey kKey{1, 1};

  SlipsTest() : world_(make_room(1)), images_(film(world_, walk_round(kImages, 1.2), {})) { make(0.75); }

  void make(double scale) {
    const int first = kEvery * (kSlip + 1);
    const Eigen::Vector3d center = images_[first].cam_from_world.center();
    const Eigen::Quaterniond turn = so3_exp({0, 5 * M_PI / 180, 0});
    moved_ = Sim3(scale, turn, center - scale * (turn * center));
    SubmapRecipe recipe{.key = kKey, .last = kImages - 1, .keyframe_every = kEvery};
    recipe.submap_from_world = random_gauge(3);
    recipe.distortion = jump(first, moved_);
    made_ = make_submap(world_, images_, recipe);
    thin_out();
    placed_ = {{kKey, {&made_.submap, rigid_placement(made_.submap, recipe.submap_from_world.inverse())}}};
    joints_ = {joint(1, 1 + kLoop), joint(4, 4 + kLoop)};
  }
  // A front that slipped makes new landmarks of what it sees again after the loop; at the slip it keeps every eighth.
  void thin_out() {
    Submap& submap = made_.submap;
    int next_id = 1'000'000;
    for (const auto& [id, landmark] : IdMap<Landmark>(submap.landmarks)) {
      const int first = landmark.observations.front().keyframe_id;
      const int renewed = next_id++;
      for (const Observation& o : landmark.observations) {
        const bool crosses = first <= kSlip && o.keyframe_id > kSlip;
        if (o.keyframe_id <= first + 20 && !(crosses && id % 8 != 0)) continue;
        if (!submap.landmark(renewed)) submap.add_landmark(renewed, landmark.position);
        submap.remove_observation(id, o.keyframe_id);
        submap.add_observation(renewed, o.keyframe_id, o.keypoint_index);
      }
    }
  }

  bool is_after(int keyframe) const { return keyframe > kSlip; }
  SE3 truth(int keyframe) const { return images_[kEvery * keyframe].cam_from_world; }
  // The length of a metre in the submap.
  double unit(int keyframe) const { return made_.submap_from_world.scale * (is_after(keyframe) ? moved_.scale : 1); }
  KeyframeJoint joint(int a, int b) const {
    const SE3 b_from_a = truth(b) * truth(a).inverse();
    return {{kKey, a}, {kKey, b},      Sim3(unit(b) / unit(a), b_from_a.rotation, unit(b) * b_from_a.translation),
            0.009,     0.03 * unit(b), 0.02};
  }
  std::vector<Slip> slips() const { return find_slips(joints_, placed_); }
  PathError bend() {
    EXPECT_TRUE(map_server::bend(
                    {joints_}, [](size_t) { return false; }, kKey, {}, &placed_)
                    .bent);
    std::vector<Eigen::Vector3d> estimate, truths;
    for (const auto& [id, keyframe] : made_.submap.keyframes) {
      estimate.push_back(placed_.at(kKey).placement.cam_from_map(keyframe).center());
      truths.push_back(truth(id).center());
    }
    return path_error(estimate, truths);
  }

  World world_;
  std::vector<Image> images_;
  Sim3 moved_;
  SyntheticSubmap made_;
  std::map<SubmapKey, PlacedSubmap> placed_;
  std::vector<KeyframeJoint> joints_;
};

TEST_F(SlipsTest, AreFoundWhereFewLandmarksHoldTheSubmapTogether) {
  ASSERT_EQ(slips().size(), 1u) << "both joints tell of the same slip";
  EXPECT_EQ(slips().front().keyframe, kSlip);
  EXPECT_EQ(slips().front().submap, kKey);
}

TEST_F(SlipsTest, TheSubmapBreaksThereAndIsNotBent) {
  const PathError error = bend();
  std::printf("ATE %.1f mm, worst %.1f mm\n", 1000 * error.rmse, 1000 * error.worst);
  EXPECT_LT(error.rmse, 0.02);
}

TEST_F(SlipsTest, AreNotLookedForBesideTheLoop) {
  joints_ = {joint(kSlip + 2, kSlip + 20)};
  EXPECT_TRUE(slips().empty());
}

TEST_F(SlipsTest, ASmallChangeOfTheScaleIsNone) {
  make(0.9);
  EXPECT_TRUE(slips().empty());
}

TEST_F(SlipsTest, NothingIsTrackedOverAHugeOne) {
  for (KeyframeJoint& joint : joints_) joint.b_from_a.scale *= 0.5;
  EXPECT_TRUE(slips().empty());
}

TEST_F(SlipsTest, AJointThatWouldTearThePathIsWrong) {
  for (KeyframeJoint& joint : joints_) joint.b_from_a.translation += Eigen::Vector3d(0, 4 * unit(kLoop), 0);
  EXPECT_TRUE(slips().empty());
}

// A joint over the whole loop whose scales are the same leaves no place for a slip.
TEST_F(SlipsTest, AnotherJointMayDenyThem) {
  joints_.push_back(joint(0, kLoop + 5));
  joints_.back().b_from_a.scale = 1;
  EXPECT_TRUE(slips().empty());
}

TEST_F(SlipsTest, WhatIsFixedStaysWhole) {
  placed_.at(kKey).fixed = true;
  EXPECT_TRUE(slips().empty());
}

}  // namespace
}  // namespace rumi::testing
