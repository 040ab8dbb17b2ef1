// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/matching/epipolar_matches.h"

#include <gtest/gtest.h>

#include "slam/geometry/epipolar.h"
#include "tests/front_tracker/feature_scene.h"

namespace rumi::front_tracker {
namespace {

struct Case {
  FeatureScene scene{5};
  std::vector<int> point_then, point_now;
  SE3 pose_then = SyntheticScene::pose(0, 0, 0), pose_now = SyntheticScene::pose(0.1, 0, 0, 0.05);
  Frame then = scene.frame(0, pose_then, &point_then), now = scene.frame(1, pose_now, &point_now);

  Case() {
    for (Frame* frame : {&then, &now})  // coarse octaves: estimate_motion() uses no others
      for (Keypoint& k : const_cast<Features&>(*frame->features).keypoints) k.octave = 3;
    then.cam_from_submap = pose_then;
  }
  EpipolarView match() const {
    return match_epipolar(test_camera(), test_octave_scales(), {then.features, then.landmark_ids, then.cam_from_submap},
                          now);
  }
};

TEST(MatchEpipolar, FindsWhatBothSee) {
  const Case c;
  const EpipolarView view = c.match();
  EXPECT_EQ(view.cam_from_submap.translation, c.pose_then.translation);
  ASSERT_GT(view.matches.size(), 200U);
  const Eigen::Matrix3d f = fundamental_matrix(test_camera(), c.pose_now * c.pose_then.inverse());
  int right = 0;
  for (const EpipolarView::Match& m : view.matches) {
    EXPECT_EQ(m.sigma_px, test_octave_scales()[3]);
    const Eigen::Vector3d line = f * m.pixel_there.homogeneous();
    right += std::abs(line.dot(m.pixel.homogeneous())) < 2.5 * line.head<2>().norm();
  }
  EXPECT_GT(right, 0.97 * static_cast<double>(view.matches.size()));
}

TEST(MatchEpipolar, LeavesOutWhatIsALandmarkInBoth) {
  Case c;
  const size_t all = c.match().matches.size();
  for (int& id : c.then.landmark_ids) id = 1;
  EXPECT_EQ(c.match().matches.size(), all);
  for (int& id : c.now.landmark_ids) id = 1;
  EXPECT_TRUE(c.match().matches.empty());
}

TEST(MatchEpipolar, OfNothingIsNothing) {
  Case c;
  c.then = make_frame(0, Features(), test_camera());
  EXPECT_TRUE(c.match().matches.empty());
}

}  // namespace
}  // namespace rumi::front_tracker
