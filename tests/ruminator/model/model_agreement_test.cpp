// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/model/model_agreement.h"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

namespace rumi::ruminator {
namespace {

using ::testing::IsEmpty;

// A walk along an arc, or along a line, with noise of a thousandth of its length.
SparseModel make_walk(int images, bool on_line, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 0.01);
  SparseModel model;
  for (int i = 0; i < images; ++i) {
    const double t = 10.0 * i / images;
    const Eigen::Vector3d center =
        (on_line ? Eigen::Vector3d(0, 0, t)
                 : Eigen::Vector3d(5 * std::cos(0.3 * t), std::sin(t), 5 * std::sin(0.3 * t))) +
        Eigen::Vector3d(noise(random), noise(random), noise(random));
    const Eigen::Quaterniond rotation(Eigen::AngleAxisd(0.1 * t + 0.1 * noise(random), Eigen::Vector3d::UnitY()));
    model.cam_from_world[i] = SE3(rotation, -(rotation * center));
  }
  return model;
}

// Returns the model in another coordinate system and unit.
SparseModel transformed(const SparseModel& model) {
  const Sim3 t(3.5, Eigen::Quaterniond(Eigen::AngleAxisd(1.2, Eigen::Vector3d(1, 2, 3).normalized())), {40, -7, 2});
  SparseModel result;
  for (const auto& [image, pose] : model.cam_from_world) result.cam_from_world[image] = t.transform_camera(pose);
  return result;
}

void displace(int first, int last, const Sim3& by, SparseModel* model) {
  for (int i = first; i <= last; ++i) model->cam_from_world[i] = by.transform_camera(model->cam_from_world[i]);
}

TEST(ModelAgreement, FindsThePartThatIsPlacedElsewhere) {
  for (const bool on_line : {false, true})
    for (unsigned seed = 1; seed <= 10; ++seed) {
      SparseModel a = make_walk(60, on_line, seed);
      const SparseModel b = transformed(make_walk(60, on_line, 100 + seed));
      displace(35, 54, Sim3(1, Eigen::Quaterniond::Identity(), {4, 0, 1}), &a);
      std::set<int> expected;
      for (int i = 0; i < 60; ++i)
        if (i < 35 || i > 54) expected.insert(i);
      EXPECT_EQ(agreeing_images(a, b), expected) << on_line << " " << seed;
      EXPECT_EQ(agreeing_images(b, a), expected) << on_line << " " << seed;
    }
}

TEST(ModelAgreement, FindsAnotherScaleAndOtherRotations) {
  SparseModel a = make_walk(60, false, 3);
  const SparseModel b = transformed(make_walk(60, false, 4));
  displace(0, 9, Sim3(0.5, Eigen::Quaterniond::Identity(), {0, 0, 0}), &a);
  for (int i = 50; i < 60; ++i) {
    const SE3 pose = a.cam_from_world[i];
    const Eigen::Quaterniond turned = Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitX()) * pose.rotation;
    a.cam_from_world[i] = SE3(turned, -(turned * pose.center()));
  }
  const std::set<int> agreed = agreeing_images(a, b);
  EXPECT_FALSE(agreed.contains(5));
  EXPECT_FALSE(agreed.contains(55));
  EXPECT_TRUE(agreed.contains(30));
  EXPECT_EQ(agreed.size(), 40u);
}

TEST(ModelAgreement, OnlyImagesThatBothHaveCount) {
  SparseModel a = make_walk(60, false, 1), b = transformed(a);
  for (int i = 0; i < 20; ++i) a.cam_from_world.erase(i);
  for (int i = 40; i < 60; ++i) b.cam_from_world.erase(i);
  const std::set<int> agreed = agreeing_images(a, b);
  EXPECT_EQ(agreed.size(), 20u);
  EXPECT_EQ(*agreed.begin(), 20);
}

TEST(ModelAgreement, IsEmptyWithoutAMajority) {
  SparseModel a = make_walk(60, false, 1);
  const SparseModel b = transformed(a);
  displace(0, 19, Sim3(1, Eigen::Quaterniond::Identity(), {4, 0, 1}), &a);
  displace(40, 59, Sim3(1, Eigen::Quaterniond::Identity(), {0, -5, 3}), &a);
  EXPECT_THAT(agreeing_images(a, b), IsEmpty());
  EXPECT_THAT(agreeing_images(a, SparseModel()), IsEmpty());
  EXPECT_THAT(agreeing_images(make_walk(5, false, 1), make_walk(5, false, 1)), IsEmpty()) << "too few to tell";
}

TEST(ModelAgreement, SurvivesAModelInOnePlace) {
  SparseModel a = make_walk(20, false, 1);
  SparseModel b = a;
  for (auto& [image, pose] : b.cam_from_world) pose = SE3(pose.rotation, Eigen::Vector3d::Zero());
  EXPECT_THAT(agreeing_images(a, b), IsEmpty());
  EXPECT_THAT(agreeing_images(b, b), IsEmpty());
}

}  // namespace
}  // namespace rumi::ruminator
