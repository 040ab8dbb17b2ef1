// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/matching/pair_motion.h"

#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "slam/geometry/transform.h"

namespace rumi::ruminator {
namespace {

Camera camera_of(double focal_px = 500) {
  Camera camera;
  camera.width = 640, camera.height = 480;
  camera.fx = camera.fy = focal_px, camera.cx = 320, camera.cy = 240;
  return camera;
}

SE3 motion_of(double turn_deg, const Eigen::Vector3d& step) {
  return {Eigen::AngleAxisd(turn_deg * M_PI / 180, Eigen::Vector3d(0.1, 1, 0.2).normalized()).toRotationMatrix(), step};
}

struct Views {
  std::vector<Eigen::Vector2f> first, second;
  IndexPairs matches;
};

// Spreads keypoints over the first image, each at its own depth, with noise of half a pixel in both images. Every fifth
// match is wrong.
Views views(const SE3& second_from_first, const std::function<double(const Eigen::Vector3d& ray, double chance)>& depth,
            int count = 300) {
  const Camera camera = camera_of();
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> noise(0, 0.5);
  const auto anywhere = [&] {
    return Eigen::Vector2d(camera.width * uniform(random), camera.height * uniform(random));
  };
  Views v;
  while (static_cast<int>(v.matches.size()) < count) {
    const Eigen::Vector2d pixel = anywhere();
    const Eigen::Vector3d ray((pixel.x() - camera.cx) / camera.fx, (pixel.y() - camera.cy) / camera.fy, 1);
    const Eigen::Vector3d there = second_from_first * Eigen::Vector3d(depth(ray, uniform(random)) * ray);
    Eigen::Vector2d seen(camera.fx * there.x() / there.z() + camera.cx, camera.fy * there.y() / there.z() + camera.cy);
    if (there.z() <= 0 || !camera.contains(seen, 0)) continue;
    if (v.matches.size() % 5 == 4) seen = anywhere();
    const auto with_noise = [&](const Eigen::Vector2d& p) {
      return Eigen::Vector2f((p + Eigen::Vector2d(noise(random), noise(random))).cast<float>());
    };
    const int index = static_cast<int>(v.first.size());
    v.first.push_back(with_noise(pixel));
    v.second.push_back(with_noise(seen));
    v.matches.emplace_back(index, index);
  }
  return v;
}

MotionKind kind_of(const Views& v, const Camera& camera = camera_of()) {
  return judge_motion(camera, v.first, v.second, v.matches).kind;
}

double in_a_room(const Eigen::Vector3d& /*ray*/, double chance) { return 2 + 3 * chance; }
// A wall that the camera looks at slightly obliquely.
double on_a_wall(const Eigen::Vector3d& ray, double /*chance*/) { return 4 / (1 + 0.3 * ray.x()); }

TEST(PairMotion, TheSamePicture) { EXPECT_EQ(kind_of(views(SE3(), in_a_room)), MotionKind::kStill); }

TEST(PairMotion, ATurn) {
  for (const double turn_deg : {1.0, 5.0, 20.0, 35.0}) {
    const PairMotion motion = [&] {
      const Views v = views(motion_of(turn_deg, {0, 0, 0}), in_a_room);
      return judge_motion(camera_of(), v.first, v.second, v.matches);
    }();
    EXPECT_EQ(motion.kind, MotionKind::kTurn) << turn_deg;
    EXPECT_NEAR(motion.turn_rad, turn_deg * M_PI / 180, 0.1 * turn_deg * M_PI / 180);
    EXPECT_GE(motion.matches, 200);
  }
}

TEST(PairMotion, ATurnThroughALensThatIsNotQuiteKnown) {
  const Views v = views(motion_of(25, {0, 0, 0}), in_a_room);
  for (const double focal_px : {450.0, 560.0})
    EXPECT_EQ(kind_of(v, camera_of(focal_px)), MotionKind::kTurn) << focal_px;
}

TEST(PairMotion, DepthInARoom) {
  for (const double turn_deg : {0.0, 5.0, 20.0})
    for (const Eigen::Vector3d& step :
         {Eigen::Vector3d(0.3, 0, 0), Eigen::Vector3d(0, 0.2, 0.2), Eigen::Vector3d(0, 0, -0.6)})
      EXPECT_EQ(kind_of(views(motion_of(turn_deg, step), in_a_room)), MotionKind::kDepth)
          << turn_deg << ", " << step.transpose();
}

TEST(PairMotion, DepthOfAPlane) {
  EXPECT_EQ(kind_of(views(motion_of(0, {0.5, 0, 0}), on_a_wall)), MotionKind::kDepth);
  EXPECT_EQ(kind_of(views(motion_of(-5, {0.4, 0.1, 0.2}), on_a_wall)), MotionKind::kDepth);
}

// A road: most points are far away, only some are near.
TEST(PairMotion, DepthOfWhatIsNearBeforeAFarLandscape) {
  const auto landscape = [](const Eigen::Vector3d&, double chance) { return chance < 0.45 ? 5 + 20 * chance : 1000; };
  EXPECT_EQ(kind_of(views(motion_of(2, {0.2, 0, -0.8}), landscape)), MotionKind::kDepth);
}

TEST(PairMotion, FewMatchesSayNothing) {
  EXPECT_EQ(kind_of(views(motion_of(5, {0.3, 0, 0}), in_a_room, 15)), MotionKind::kUnknown);
  Views wrong = views(SE3(), in_a_room, 60);
  std::shuffle(wrong.second.begin(), wrong.second.end(), std::mt19937(3));
  EXPECT_EQ(kind_of(wrong), MotionKind::kUnknown) << "all matches are wrong";
  EXPECT_EQ(kind_of({}), MotionKind::kUnknown);
}

TEST(PairMotion, MatchesOfOnePointSayNothing) {
  Views v;
  for (int i = 0; i < 50; ++i) {
    v.first.emplace_back(100, 100);
    v.second.emplace_back(120, 110);
    v.matches.emplace_back(i, i);
  }
  EXPECT_NE(kind_of(v), MotionKind::kDepth);
}

}  // namespace
}  // namespace rumi::ruminator
