// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/frame/weigh_by_area.h"

#include <gtest/gtest.h>

#include <limits>
#include <numeric>

#include "tests/slam/synthetic_scene.h"

namespace rumi::front_tracker {
namespace {

std::vector<PointObservation> see(SyntheticScene& scene, const SE3& pose, const std::vector<Eigen::Vector3d>& points) {
  std::vector<PointObservation> observations;
  for (const Eigen::Vector3d& p : points) {
    const Eigen::Vector2d pixel = test_camera().project_undistorted(pose * p);
    if (test_camera().contains(pixel)) observations.push_back({p, pixel + scene.noise(0.5), 1.0});
  }
  return observations;
}

// Returns points of the lettering on the side of a lorry, 4 m away; it covers about a sixth of the image's width and of
// its height.
std::vector<Eigen::Vector3d> lettering(SyntheticScene& scene, int count) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < count; ++i) points.emplace_back(scene.uniform(-0.4, 0.4), scene.uniform(-0.3, 0.3), 4.0);
  return points;
}

TEST(WeighByArea, EachPartOfTheImageHasOneVoice) {
  std::vector<PointObservation> observations(30);
  for (size_t i = 0; i < observations.size(); ++i) {
    observations[i].pixel =
        i < 29 ? Eigen::Vector2d(110 + 0.5 * static_cast<double>(i), 100) : Eigen::Vector2d(500, 300);
  }
  weigh_by_area(test_camera(), &observations);
  const double dense = std::accumulate(observations.begin(), observations.end() - 1, 0.0,
                                       [](double sum, const PointObservation& o) { return sum + o.weight; });
  EXPECT_NEAR(dense, observations.back().weight, 1e-9);
  EXPECT_NEAR(dense + observations.back().weight, 30, 1e-9) << "1 in the mean";
}

TEST(WeighByArea, BesideTheImageAndNowhereAreInCellsToo) {
  std::vector<PointObservation> observations(4);
  observations[0].pixel = {-50, 1e9};
  observations[1].pixel = {1e9, -50};
  observations[2].pixel = {std::numeric_limits<double>::quiet_NaN(), 3};
  observations[3].pixel = {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  weigh_by_area(test_camera(), &observations);
  for (const PointObservation& o : observations) EXPECT_GT(o.weight, 0);
  std::vector<PointObservation> none;
  weigh_by_area(test_camera(), &none);
  EXPECT_TRUE(none.empty());
}

// A lorry keeps pace with the camera, so its landmarks say that the camera has not moved. It has more of them than the
// street.
TEST(WeighByArea, ALorryDoesNotOutvoteTheStreet) {
  int outvoted = 0;
  constexpr int kSeeds = 20;
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    SyntheticScene scene(seed);
    const SE3 before, now = SyntheticScene::pose(0.0, 0.0, 0.3, 0.0, 0.0);
    std::vector<PointObservation> observations = see(scene, now, scene.cloud(100));
    const std::vector<PointObservation> lorry = see(scene, before, lettering(scene, 500));
    ASSERT_GT(lorry.size(), observations.size());
    observations.insert(observations.end(), lorry.begin(), lorry.end());
    const auto off = [&] {
      return (optimize_pose(test_camera(), before, observations).cam_from_submap.center() - now.center()).norm();
    };
    outvoted += off() > 0.1;
    weigh_by_area(test_camera(), &observations);
    EXPECT_LT(off(), 0.03) << seed;
  }
  EXPECT_GT(outvoted, kSeeds / 2) << "with equal weights it does";
}

}  // namespace
}  // namespace rumi::front_tracker
