// SPDX-License-Identifier: BSD-3-Clause
#include "slam/geometry/alignment.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/slam/synthetic_scene.h"

namespace rumi {
namespace {

TEST(Umeyama, RecoversSimilarity) {
  SyntheticScene scene(1);
  const std::vector<Eigen::Vector3d> source = scene.cloud(50);
  const Sim3 truth(0.3, so3_exp({0.3, -1.2, 2.0}), Eigen::Vector3d(4, -5, 6));
  std::vector<Eigen::Vector3d> target;
  for (const auto& p : source) target.push_back(truth * p);
  const auto found = umeyama(source, target);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->scale, truth.scale, 1e-12);
  EXPECT_LT((found->translation - truth.translation).norm(), 1e-10);
  EXPECT_LT(found->rotation.angularDistance(truth.rotation), 1e-7);
  const auto rigid = umeyama(source, target, false);
  ASSERT_TRUE(rigid);
  EXPECT_EQ(rigid->scale, 1.0);
}

TEST(Umeyama, NoiseAveragesOut) {
  SyntheticScene scene(2);
  const std::vector<Eigen::Vector3d> source = scene.cloud(1000);
  const Sim3 truth(2.0, so3_exp({0.1, 0.2, 0.3}), Eigen::Vector3d(1, 2, 3));
  std::vector<Eigen::Vector3d> target;
  for (const auto& p : source)
    target.push_back(truth * p +
                     Eigen::Vector3d(scene.uniform(-0.1, 0.1), scene.uniform(-0.1, 0.1), scene.uniform(-0.1, 0.1)));
  const auto found = umeyama(source, target);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->scale, 2.0, 0.01);
  EXPECT_LT(found->rotation.angularDistance(truth.rotation), 0.003);
}

TEST(Umeyama, PlanarPointsAreNotMirrored) {
  std::vector<Eigen::Vector3d> source{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, target;
  const Sim3 truth(1.0, so3_exp({3.0, 0.1, 0}), Eigen::Vector3d::Zero());
  for (const auto& p : source) target.push_back(truth * p);
  const auto found = umeyama(source, target);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->rotation.toRotationMatrix().determinant(), 1.0, 1e-9);
  EXPECT_LT(found->rotation.angularDistance(truth.rotation), 1e-6);
}

TEST(Umeyama, RefusesWhatCannotBeAligned) {
  const std::vector<Eigen::Vector3d> two{{0, 0, 0}, {1, 0, 0}};
  EXPECT_FALSE(umeyama(two, two));
  const std::vector<Eigen::Vector3d> same(5, Eigen::Vector3d(1, 2, 3));
  EXPECT_FALSE(umeyama(same, same));
  const std::vector<Eigen::Vector3d> three{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_FALSE(umeyama(three, two));
  std::vector<Eigen::Vector3d> bad = three;
  bad[1].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(umeyama(bad, three));
  EXPECT_FALSE(umeyama(three, bad));
}

}  // namespace
}  // namespace rumi
