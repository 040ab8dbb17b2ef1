// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/frame/established_first.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "front_tracker/frame/front_submap.h"
#include "slam/features/pyramid.h"
#include "tests/slam/synthetic_scene.h"

namespace rumi::front_tracker {
namespace {

// Landmarks that some keyframes have seen, and a frame that sees them from a pose of its own or of theirs.
class EstablishedFirst : public ::testing::Test {
 protected:
  EstablishedFirst() {
    submap_.map.camera = test_camera();
    submap_.octave_scales = Pyramid().scales();
  }

  // `count` landmarks, seen by so many keyframes; the frame sees them as from `cam_from_submap`.
  void add(int count, int keyframes, const SE3& cam_from_submap) {
    for (int i = 0; i < count; ++i) {
      const double z = scene_.uniform(1.5, 2.5);
      const double y = z * scene_.uniform(-0.35, 0.35);
      points_.emplace_back(z * scene_.uniform(-0.45, 0.45), y, z);
      keyframes_.push_back(keyframes);
      const Eigen::Vector2d pixel = submap_.map.camera.project_undistorted(cam_from_submap * points_.back());
      seen_.keypoints.push_back({(pixel + scene_.noise(0.4)).cast<float>(), 0, 0});
      seen_.descriptors.emplace_back();
    }
  }
  // refine_pose() of the frame, which begins between the two poses. The number of inliers.
  int refine(const std::vector<EpipolarView>& views = {}) {
    const size_t n = points_.size();
    Features anything;
    anything.keypoints.resize(n);
    anything.descriptors.resize(n);
    for (int i = 0; i < kMostKeyframes; ++i) {
      Frame keyframe = make_frame(1000 * (i + 1), anything, submap_.map.camera);
      submap_.add_keyframe(&keyframe);
    }
    frame_ = make_frame(1'000'000, seen_, submap_.map.camera);
    for (size_t i = 0; i < n; ++i) {
      const int id = submap_.add_landmark(points_[i]).id;
      for (int k = 0; k < keyframes_[i]; ++k) submap_.map.add_observation(id, k, static_cast<int>(i));
      frame_.landmark_ids[i] = id;
    }
    frame_.cam_from_submap = SyntheticScene::pose(0.115, 0, 0);
    return refine_pose(submap_.map.camera, submap_.map, submap_.octave_scales, &frame_, views);
  }
  double off_m(const SE3& pose) const { return (frame_.cam_from_submap.center() - pose.center()).norm(); }
  int matched_from(size_t first, size_t end) const {
    int matched = 0;
    for (size_t i = first; i < end; ++i) matched += frame_.landmark_ids[i] != kNone;
    return matched;
  }

  static constexpr int kMostKeyframes = 5, kOld = 4, kYoung = 2;
  const SE3 true_pose_ = SyntheticScene::pose(0.1, 0, 0), other_pose_ = SyntheticScene::pose(0.13, 0, 0);
  SyntheticScene scene_{1};
  FrontSubmap submap_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<int> keyframes_;  // that have seen each
  Features seen_;
  Frame frame_;
};

TEST_F(EstablishedFirst, ManyYoungLandmarksDoNotOutvoteThem) {
  add(40, kOld, true_pose_);
  add(120, kYoung, other_pose_);
  EXPECT_GE(refine(), 36);
  EXPECT_LT(off_m(true_pose_), 0.006);
  EXPECT_GE(matched_from(0, 40), 36);
  EXPECT_EQ(matched_from(40, 160), 0);
}

TEST_F(EstablishedFirst, WithoutThemMostLandmarksDecide) {
  add(40, kYoung, true_pose_);
  add(120, kYoung, other_pose_);
  EXPECT_GE(refine(), 108);
  EXPECT_LT(off_m(other_pose_), 0.006);
  EXPECT_GE(matched_from(40, 160), 108);
}

TEST_F(EstablishedFirst, AFewAreNotEnough) {
  add(29, kOld, true_pose_);
  add(120, kYoung, other_pose_);
  refine();
  EXPECT_LT(off_m(other_pose_), 0.006);
}

// Most of the old ones have nothing in common: they may have been made where the map is wrong.
TEST_F(EstablishedFirst, ThoseThatDisagreeDecideNothing) {
  for (int i = 0; i < 60; ++i) add(1, kOld, SyntheticScene::pose(scene_.uniform(-0.5, 0.5), scene_.uniform(-1, 1), 0));
  add(120, kYoung, other_pose_);
  refine();
  EXPECT_LT(off_m(other_pose_), 0.006);
  EXPECT_GE(matched_from(60, 180), 108);
}

TEST_F(EstablishedFirst, YoungOnesThatAgreeStay) {
  add(40, kOld, true_pose_);
  add(100, kYoung, true_pose_);
  EXPECT_GE(refine(), 126);
  EXPECT_LT(off_m(true_pose_), 0.006);
  EXPECT_GE(matched_from(40, 140), 90);
}

TEST_F(EstablishedFirst, OnlyWhatContradictsIsTakenOutOfBoth) {
  add(40, kOld, true_pose_);
  add(10, kYoung, other_pose_);
  add(10, kYoung, true_pose_);
  refine();
  for (size_t i = 0; i < 60; ++i) frame_.landmark_ids[i] = static_cast<int>(i);  // as before
  FrameObservations matched = observations_of(frame_, submap_.map, submap_.octave_scales);
  SE3 pose = SyntheticScene::pose(0.115, 0, 0);
  begin_with_established(submap_.map, &frame_, &pose, &matched);
  EXPECT_LT((pose.center() - true_pose_.center()).norm(), 0.006);
  ASSERT_EQ(matched.keypoints.size(), 50u);
  ASSERT_EQ(matched.observations.size(), 50u);
  EXPECT_EQ(matched_from(0, 40), 40);
  EXPECT_EQ(matched_from(40, 50), 0);
  EXPECT_EQ(matched_from(50, 60), 10);
  EXPECT_EQ(matched.keypoints.back(), 59);
  EXPECT_EQ(matched.observations.back().point, points_[59]);
}

}  // namespace
}  // namespace rumi::front_tracker
