// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/atlas/placement.h"

#include "tests/map_server/test_atlas.h"

namespace rumi::map_server {
namespace {

using testing::make_placement;
using testing::make_submap;

TEST(Placement, AWholeSimilarityKeepsWhatTheCamerasSee) {
  const Submap submap = make_submap({7, 1}, 5, 4);
  Placement placement;
  placement.map_from_submap[0] = Sim3(2.5, so3_exp({0.1, -0.7, 0.3}), Eigen::Vector3d(4, 5, 6));
  const Submap placed = place(submap, placement);
  for (const auto& [id, keyframe] : submap.keyframes)
    for (const auto& [landmark_id, landmark] : submap.landmarks) {
      const Eigen::Vector3d in_cam = keyframe.cam_from_submap * landmark.position;
      const Eigen::Vector3d in_cam_again =
          placed.keyframe(id)->cam_from_submap * placed.landmark(landmark_id)->position;
      EXPECT_LT((in_cam_again - 2.5 * in_cam).norm(), 1e-12);
    }
  for (const auto& [utime_us, frame] : submap.frames) {
    const Eigen::Vector3d centre = placement.latest() * submap.cam_from_submap(frame).center();
    EXPECT_LT((placed.cam_from_submap(*placed.frame(utime_us)).center() - centre).norm(), 1e-12);
    EXPECT_LT((placement.cam_from_map(submap, frame).center() - centre).norm(), 1e-12);
  }
}

TEST(Placement, NothingIsTheIdentity) {
  const Submap submap = make_submap({7, 1}, 5, 4);
  testing::expect_same(submap, place(submap, {}));
}

TEST(Placement, TheNearestKeyframeIsFollowed) {
  Placement placement;
  for (const int64_t t : {100, 200, 400}) placement.map_from_submap[t].scale = static_cast<double>(t);
  for (const auto& [t, scale] : {std::pair{0, 100}, {100, 100}, {150, 100}, {151, 200}, {299, 200}, {301, 400}})
    EXPECT_EQ(placement.at(t).scale, scale) << t;
  EXPECT_EQ(placement.at(9999).scale, 400);
  EXPECT_EQ(placement.latest().scale, 400);
}

TEST(Placement, AnAdjustedLandmarkIsWhereItWasPut) {
  const Submap submap = make_submap({7, 1}, 5, 4);
  const Placement placement = make_placement(submap, 3);
  ASSERT_FALSE(placement.landmarks.empty());
  const Submap placed = place(submap, placement);
  for (const auto& [id, position] : placement.landmarks) EXPECT_EQ(placed.landmark(id)->position, position);
}

TEST(Placement, SameToTheLastBitOnly) {
  const Placement one = make_placement(make_submap({7, 1}, 5, 4), 3);
  Placement other = one;
  other.revision = 77;
  EXPECT_TRUE(same_place(one, other));
  other.fused[0] = {{7, 2}, 1};
  EXPECT_FALSE(same_place(one, other));
  other = one;
  other.map_from_submap.begin()->second.rotation.x() += 1e-16;
  EXPECT_FALSE(same_place(one, other));
  other = one;
  other.landmarks.erase(other.landmarks.begin());
  EXPECT_FALSE(same_place(one, other));
}

}  // namespace
}  // namespace rumi::map_server
