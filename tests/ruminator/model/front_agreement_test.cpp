// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/model/front_agreement.h"

#include <gtest/gtest.h>

#include "tests/ruminator/test_window.h"

namespace rumi::ruminator {
namespace {

// Samples 0 .. n-1 are in submap 3, n .. 2n-1 in submap 5. Each submap has its own origin and unit.
struct Fixture {
  std::vector<Sample> samples;
  std::map<int64_t, SE3> cam_from_model;
};

Fixture make_fixture(int n) {
  Fixture f;
  const Sim3 submap_from_model[] = {{2.5, so3_exp({0.3, -0.2, 1}), {1, 2, 3}},
                                    {0.4, so3_exp({-1, 0, 0.5}), {-4, 0, 1}}};
  const std::vector<SE3> path = testing::sideways_path(2 * n);
  for (int i = 0; i < 2 * n; ++i) {
    const int64_t utime = 1000 + 100 * i;
    f.cam_from_model[utime] = path[i];
    f.samples.push_back({.utime_us = utime,
                         .submap_id = i < n ? 3 : 5,
                         .cam_from_submap = submap_from_model[i < n ? 0 : 1].transform_camera(path[i])});
  }
  return f;
}

TEST(FrontAgreement, OfTheSameShapeIsPerfectInEachSubmap) {
  const Fixture f = make_fixture(6);
  const auto agreement = compare_with_front(f.samples, f.cam_from_model);
  ASSERT_EQ(agreement.size(), 2U);
  EXPECT_EQ(agreement[0].submap_id, 3);
  EXPECT_EQ(agreement[1].submap_id, 5);
  for (const FrontAgreement& a : agreement) {
    EXPECT_EQ(a.frames, 6);
    EXPECT_NEAR(a.rotation_deg, 0, 1e-5);
    EXPECT_NEAR(a.position_ratio, 0, 1e-6);
  }
}

TEST(FrontAgreement, TellsHowFarABentModelIsOff) {
  Fixture f = make_fixture(8);
  int i = 0;
  for (auto& [utime, pose] : f.cam_from_model) pose = SE3(so3_exp({0, 0.1 * i++, 0}), pose.translation);
  for (const FrontAgreement& a : compare_with_front(f.samples, f.cam_from_model)) {
    EXPECT_NEAR(a.rotation_deg, 0.1 * 2 * 180 / M_PI, 1.5);  // half of the frames are at most two steps from the middle
    EXPECT_GT(a.position_ratio, 0.02);
    EXPECT_LT(a.position_ratio, 1.0001);
  }
}

TEST(FrontAgreement, OneWrongFrameDoesNotSpoilTheRotation) {
  Fixture f = make_fixture(7);
  f.cam_from_model.begin()->second.rotation = so3_exp({0, 2, 0});
  EXPECT_NEAR(compare_with_front(f.samples, f.cam_from_model)[0].rotation_deg, 0, 1e-5);
}

TEST(FrontAgreement, NeedsFramesThatBothHave) {
  Fixture f = make_fixture(6);
  EXPECT_TRUE(compare_with_front({}, f.cam_from_model).empty());
  EXPECT_TRUE(compare_with_front(f.samples, {}).empty());
  const Fixture few = make_fixture(4);
  EXPECT_TRUE(compare_with_front(few.samples, few.cam_from_model).empty());
  f.samples[0].submap_id = kNoSubmap;
  f.cam_from_model.erase(f.samples[1].utime_us);
  const auto agreement = compare_with_front(f.samples, f.cam_from_model);
  ASSERT_EQ(agreement.size(), 1U);
  EXPECT_EQ(agreement[0].submap_id, 5);
}

TEST(FrontAgreement, OfACameraThatStoodStillTellsNothingOfPositions) {
  Fixture f = make_fixture(6);
  for (Sample& sample : f.samples) sample.cam_from_submap = SE3();
  for (const FrontAgreement& a : compare_with_front(f.samples, f.cam_from_model)) EXPECT_EQ(a.position_ratio, 1);
}

}  // namespace
}  // namespace rumi::ruminator
