// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/rebuild/back_landmarks.h"

#include <gtest/gtest.h>

#include "bus/wire/image_codec.h"
#include "bus/wire/submap_update.h"
#include "tests/ruminator/rendered_window.h"
#include "tests/ruminator/test_window.h"

namespace rumi::ruminator {
namespace {

// Frames 0, 1, 2, 4, 5, 6 with their true poses, and points whose tracks tell which frames see the same place.
struct Fixture {
  Camera camera;
  std::vector<SeenImage> images;
  SparseModel model;
};

Fixture make_fixture() {
  const testing::RenderedWindow& window = testing::rendered_window();
  Fixture f;
  f.camera = window.job.camera;
  for (int i = 0; i < 7; ++i) {
    f.images.push_back({window.job.images[i].utime, decode_grey(window.job.images[i]).value()});
    if (i != 3) f.model.cam_from_world[i] = window.cam_from_map[i];
  }
  // Adds points 3 m in front of the middle frame.
  SyntheticScene random(1);
  for (int p = 0; p < 30; ++p) {
    const Eigen::Vector3d in_camera(random.uniform(-1, 1), random.uniform(-0.8, 0.8), 3);
    SparseModel::Point point{window.cam_from_map[3].inverse() * in_camera, {}};
    for (const auto& [image, pose] : f.model.cam_from_world) point.track.emplace_back(image, p);
    f.model.points.push_back(point);
  }
  return f;
}

Submap fill(const Fixture& f) {
  Submap submap;
  submap.key = {5, -1};
  submap.kind = SubmapKind::kBack;
  submap.camera = f.camera;
  submap.revision = 1;
  fill_back_submap(f.camera, f.images, f.model, &submap);
  return submap;
}

TEST(BackLandmarks, HaveDescriptorsViewsAndSmallErrors) {
  const Fixture f = make_fixture();
  const Submap submap = fill(f);
  ASSERT_EQ(submap.keyframes.size(), 6U);
  ASSERT_EQ(submap.frames.size(), 6U);
  ASSERT_GT(submap.landmarks.size(), 150U);
  std::vector<double> errors_px;
  int with_three = 0;
  for (const auto& [id, landmark] : submap.landmarks) {
    EXPECT_EQ(landmark.id, id);
    EXPECT_NE(landmark.descriptor, Descriptor{});
    EXPECT_NEAR(landmark.view_direction.norm(), 1, 0.5);
    EXPECT_GT(landmark.octave0_distance, 0);
    ASSERT_GE(landmark.observations.size(), 2U);
    with_three += landmark.observations.size() >= 3;
    for (const Observation& o : landmark.observations) {
      const Keyframe& keyframe = submap.keyframes.at(o.keyframe_id);
      EXPECT_EQ(keyframe.landmark_ids[o.keypoint_index], id);
      const Eigen::Vector3d in_camera = keyframe.cam_from_submap * landmark.position;
      EXPECT_GT(in_camera.z(), 0);
      const Eigen::Vector2f seen = keyframe.features->undistorted[o.keypoint_index];
      errors_px.push_back((f.camera.project_undistorted(in_camera) - seen.cast<double>()).norm());
    }
  }
  EXPECT_GT(with_three, 50);
  std::sort(errors_px.begin(), errors_px.end());
  EXPECT_LT(errors_px[errors_px.size() / 2], 1);
  EXPECT_LT(errors_px[errors_px.size() * 9 / 10], 3);
}

TEST(BackLandmarks, KeepThePosesUpToTheUnit) {
  const Fixture f = make_fixture();
  const Submap submap = fill(f);
  int id = 0;
  for (const auto& [image, pose] : f.model.cam_from_world) {
    const Keyframe& keyframe = submap.keyframes.at(id);
    EXPECT_EQ(keyframe.id, id++);
    EXPECT_EQ(keyframe.utime_us, f.images[image].utime_us);
    EXPECT_LT(keyframe.cam_from_submap.rotation.angularDistance(pose.rotation), 1e-9);
    EXPECT_LT((3.0 * keyframe.cam_from_submap.translation - pose.translation).norm(),
              0.1 * pose.translation.norm());  // because the unit, the median depth, is about 3 m
  }
}

TEST(BackLandmarks, AreTheSameEveryTime) {
  const Fixture f = make_fixture();
  const submap_update_t once = make_submap_update(fill(f), 0), again = make_submap_update(fill(f), 0);
  std::vector<uint8_t> bytes(once.getEncodedSize()), others(again.getEncodedSize());
  once.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  again.encode(others.data(), 0, static_cast<int>(others.size()));
  EXPECT_EQ(bytes, others);
}

TEST(BackLandmarks, AreNoneWhereTheMasksLeaveSomethingOut) {
  Fixture f = make_fixture();
  const int half = f.camera.width / 2;
  for (SeenImage& image : f.images) {
    cv::Mat pixels(image.grey.size(), CV_8U, cv::Scalar(255));
    pixels.colRange(0, half) = 0;
    image.mask = ImageMask(pixels);
  }
  const Submap submap = fill(f);
  EXPECT_GT(submap.landmarks.size(), 50U);
  for (const auto& [id, keyframe] : submap.keyframes)
    for (const Keypoint& keypoint : keyframe.features->keypoints) ASSERT_GE(keypoint.pixel.x(), half);
}

TEST(BackLandmarks, AreNoneWhereNothingIsShared) {
  Fixture f = make_fixture();
  f.model.points.clear();
  const Submap submap = fill(f);
  EXPECT_EQ(submap.keyframes.size(), 6U);
  EXPECT_TRUE(submap.landmarks.empty());
  Fixture black = make_fixture();
  for (SeenImage& image : black.images) image.grey.setTo(0);
  EXPECT_TRUE(fill(black).landmarks.empty());
  Fixture nothing = make_fixture();
  nothing.model = {};
  EXPECT_TRUE(fill(nothing).keyframes.empty());
}

}  // namespace
}  // namespace rumi::ruminator
