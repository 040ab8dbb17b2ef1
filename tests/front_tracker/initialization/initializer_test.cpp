// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/initialization/initializer.h"

#include <gtest/gtest.h>

#include "slam/geometry/alignment.h"
#include "tests/front_tracker/feature_scene.h"

namespace rumi::front_tracker {
namespace {

using Motion = std::function<SE3(int)>;

std::optional<InitialMap> run(FeatureScene& scene, const Motion& motion, int frames, std::string* refusal = nullptr) {
  Initializer initializer(test_camera(), {}, test_octave_scales());
  for (int i = 0; i < frames; ++i) {
    auto map = initializer.add(scene.frame(33'333 * (i + 1), motion(i)));
    if (map) return std::move(*map);
  }
  if (refusal) *refusal = initializer.refusal();
  return std::nullopt;
}

void expect_true_structure(const InitialMap& map, const Motion& motion) {
  std::vector<Eigen::Vector3d> estimated, truth;
  for (const InitialMap::View& v : map.views) {
    estimated.push_back(v.cam_from_submap.center());
    truth.push_back(motion(static_cast<int>(v.frame)).center());
  }
  const auto truth_from_submap = umeyama(estimated, truth);
  ASSERT_TRUE(truth_from_submap);
  double path = (truth.front() - truth[1]).norm();
  for (size_t i = 0; i < truth.size(); ++i)
    EXPECT_LT((*truth_from_submap * estimated[i] - truth[i]).norm(), 0.05 * path);
  const SE3 reference = motion(static_cast<int>(map.views[0].frame));
  for (const InitialMap::View& v : map.views)
    EXPECT_LT(rotation_error_deg(v.cam_from_submap, motion(static_cast<int>(v.frame)) * reference.inverse()), 0.7);
}

TEST(Initializer, SidewaysMotionGivesTrueStructureAndEveryFrameAPose) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    FeatureScene scene(seed);
    const Motion motion = [](int i) { return SyntheticScene::pose(0.03 * i, 0.005 * i, 0.01 * i, -0.003 * i); };
    const auto map = run(scene, motion, 60);
    ASSERT_TRUE(map) << seed;
    expect_true_structure(*map, motion);
    EXPECT_GE(map->views.size(), std::min<size_t>(map->frames.size(), 10)) << "frames between have poses too";
    EXPECT_GE(map->points.size(), 60u);
    int keyframes = 0;
    for (const auto& v : map->views) keyframes += v.keyframe;
    EXPECT_GE(keyframes, 2);
    EXPECT_LE(keyframes, 6);
  }
}

TEST(Initializer, NeverBeginsFromPureRotation) {
  for (unsigned seed = 0; seed < 3; ++seed) {
    FeatureScene scene(seed, 1500);
    const Motion motion = [](int i) { return SyntheticScene::pose(0, 0, 0, 0.008 * i, 0.002 * i); };
    EXPECT_FALSE(run(scene, motion, 40));
  }
}

TEST(Initializer, TriesNothingWhileTheCameraOnlyTurns) {
  FeatureScene scene(2, 1500);
  std::string refusal;
  EXPECT_FALSE(run(
      scene, [](int i) { return SyntheticScene::pose(0, 0, 0, 0.008 * i); }, 12, &refusal));
  EXPECT_NE(refusal.find("beyond a rotation"), std::string::npos) << refusal;
}

TEST(Initializer, APairAloneIsNoStart) {
  FeatureScene scene(2);
  const auto far_apart = [](int i) { return SyntheticScene::pose(0.4 * i, 0, 0, -0.05 * i); };
  EXPECT_FALSE(run(scene, far_apart, 2)) << "no frame between to judge by";
  EXPECT_TRUE(run(scene, far_apart, 4));
}

TEST(Initializer, WaitsUntilTheDirectionOfTheMotionIsKnown) {
  const Motion motion = [](int i) { return SyntheticScene::pose(0.01 * i, 0.002 * i, 0); };
  constexpr int kNever = 100;
  const auto begins_at = [&](unsigned seed, double max_direction_rad, std::string* refusals) {
    FeatureScene scene(seed);
    InitializerOptions options;
    options.max_direction_sigma_rad = max_direction_rad;
    Initializer initializer(test_camera(), options, test_octave_scales());
    for (int i = 0; i < kNever; ++i) {
      if (initializer.add(scene.frame(33'333 * (i + 1), motion(i)))) return i;
      *refusals += initializer.refusal() + "\n";
    }
    return kNever;
  };
  for (unsigned seed = 0; seed < 5; ++seed) {
    std::string refusals;
    const int regardless = begins_at(seed, 10, &refusals);
    EXPECT_EQ(refusals.find("waiting for more motion"), std::string::npos) << refusals;
    const int later = begins_at(seed, 0.005, &refusals);
    EXPECT_NE(refusals.find("waiting for more motion"), std::string::npos) << refusals;
    EXPECT_LT(regardless, later);
    EXPECT_LT(later, kNever) << "and then it begins" << refusals;
  }
}

TEST(Initializer, NeverBeginsFromAStillCamera) {
  FeatureScene scene(1);
  std::string refusal;
  EXPECT_FALSE(run(
      scene, [](int) { return SE3(); }, 30, &refusal));
  EXPECT_FALSE(refusal.empty());
}

TEST(Initializer, APlaneBeginsRightOrNotAtAll) {
  int begun = 0;
  for (unsigned seed = 0; seed < 5; ++seed) {
    FeatureScene scene(seed);
    for (Eigen::Vector3d& p : scene.points()) p *= 4.0 / (p.z() + 0.4 * p.x() + 0.2 * p.y());
    const Motion motion = [](int i) {
      return SyntheticScene::pose(0.03 * i, 0.002 * i * i * 0.3, 0.01 * i, -0.004 * i);
    };
    const auto map = run(scene, motion, 50);
    if (!map) continue;
    ++begun;
    expect_true_structure(*map, motion);
  }
  EXPECT_GE(begun, 3);
}

// Two views of a plane allow a second, wrong motion: one along the plane's normal. It has parallax, unlike the true
// motion, which leads towards the plane at a slant. The wall is a little uneven, so the true motion fits better.
TEST(Initializer, TheGhostOfDrivingTowardsAWallIsNoStart) {
  for (unsigned seed = 0; seed < 8; ++seed) {
    FeatureScene scene(seed);
    SyntheticScene random(seed);
    for (Eigen::Vector3d& p : scene.points()) p *= random.uniform(3.6, 4.4) / (p.z() + 0.8 * p.x());
    const Motion motion = [](int i) { return SyntheticScene::pose(0, 0, 0.02 * i, 0.01 * i); };
    if (const auto map = run(scene, motion, 30)) {
      EXPECT_LT(rotation_error_deg(map->views[1].cam_from_submap,
                                   motion(static_cast<int>(map->views[1].frame)) *
                                       motion(static_cast<int>(map->views[0].frame)).inverse()),
                0.7)
          << seed;
    }
  }
}

TEST(Initializer, UnrelatedImagesAndEmptyOnesGiveNothing) {
  Initializer initializer(test_camera(), {}, test_octave_scales());
  for (int i = 0; i < 10; ++i) {
    FeatureScene other(100 + i);
    EXPECT_FALSE(initializer.add(other.frame(1000 * i, SE3())));
    EXPECT_FALSE(initializer.add(make_frame(1000 * i + 500, Features{}, test_camera())));
  }
}

// Neither hours in the dark nor seconds without parallax may fill the memory.
TEST(Initializer, KeepsImagesOnlyOfWhatMayBecomeAKeyframe) {
  FeatureScene scene(0);
  Initializer initializer(test_camera(), {}, test_octave_scales());
  std::vector<std::weak_ptr<const ImagePyramid>> given;
  const auto add = [&](const SE3& cam_from_world, bool dark) {
    Frame frame = scene.frame(33'333 * static_cast<int64_t>(given.size() + 1), cam_from_world);
    if (dark) frame = make_frame(frame.utime_us, {}, test_camera());
    auto images = std::make_shared<const ImagePyramid>(cv::Mat::zeros(480, 640, CV_8U), test_octave_scales());
    given.push_back(images);
    frame.images = std::move(images);
    return initializer.add(std::move(frame));
  };
  constexpr int kDark = 5;
  Result<InitialMap> map = Error{"not begun"};
  for (int i = 0; i < 60 && !map; ++i) map = add(SyntheticScene::pose(0.03 * (i - kDark), 0, 0), i < kDark);
  ASSERT_TRUE(map);
  for (const auto& images : given) EXPECT_TRUE(images.expired()) << "the smaller images are not kept";
  for (int i = 0; i < kDark; ++i) EXPECT_FALSE(map->frames[i].images) << "dark image " << i;
  for (const InitialMap::View& view : map->views) {
    if (!view.keyframe) continue;
    ASSERT_TRUE(map->frames[view.frame].images);
    EXPECT_EQ(map->frames[view.frame].images->levels(), 1);
  }
}

}  // namespace
}  // namespace rumi::front_tracker
