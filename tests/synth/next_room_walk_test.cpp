// SPDX-License-Identifier: BSD-3-Clause
#include "synth/next_room_walk.h"

#include <gtest/gtest.h>

#include "synth/options.h"

namespace rumi::synth {
namespace {

using Eigen::Vector3d;

constexpr double kFloor_m = -0.2;  // lower than any floor: the camera is at least 1.2 m above the floor

// True if any part of the doorway's opening would be in the image if nothing stood before it.
bool sees_the_doorway(const SE3& map_from_cam, const Doorway& door, const Camera& camera) {
  const SE3 cam_from_map = map_from_cam.inverse();
  constexpr double kMargin_px = 5;
  for (double y = -door.width_m / 2; y <= door.width_m / 2 + 1e-9; y += door.width_m / 26)
    for (double z = kFloor_m; z <= door.height_m + 0.2; z += 0.05) {
      const Vector3d p = cam_from_map * Vector3d(door.at.x(), door.at.y() + y, z);
      if (p.z() <= 0) continue;
      const double u = camera.fx * p.x() / p.z() + camera.cx, v = camera.fy * p.y() / p.z() + camera.cy;
      if (u > -kMargin_px && u < camera.width + kMargin_px && v > -kMargin_px && v < camera.height + kMargin_px)
        return true;
    }
  return false;
}

TEST(NextRoomWalk, NeitherRoomIsSeenFromTheOtherBeforeAndAfterThePassage) {
  const Camera camera = default_synth_camera(640, 480);
  for (const double seconds : {kMinNextRoomSeconds, 20.0, 22.0, 40.0})
    for (uint64_t seed = 1; seed <= 12; ++seed) {
      const Walk walk = walk_to_next_room(seconds, seed);
      const double begin_s = walk.path.times_s().front();
      const double dark_s = begin_s + walk.hard.front().at_s, light_s = dark_s + walk.hard.front().for_s;
      bool seen = false;
      for (const double t : walk.path.times_s()) {
        const SE3 pose = walk.path.at(t);
        if (t > dark_s && t < light_s) {
          seen |= sees_the_doorway(pose, *walk.doorway, camera);
          continue;
        }
        ASSERT_EQ(pose.translation.x() < 0, t <= dark_s) << "seed " << seed << " at " << t - begin_s << " s";
        ASSERT_FALSE(sees_the_doorway(pose, *walk.doorway, camera))
            << seconds << " s, seed " << seed << " at " << t - begin_s << " s";
      }
      EXPECT_TRUE(seen) << "the passage leads through the doorway";
    }
}

TEST(NextRoomWalk, GoesThroughTheDoorwayAndTouchesNothing) {
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    const Walk walk = walk_to_next_room(22, seed);
    const Doorway& door = *walk.doorway;
    const RoomShape shape = fit_room(walk.path, seed, door);
    ASSERT_EQ(shape.rooms().size(), 2u);
    EXPECT_LT((shape.room_from_map.rotation.angularDistance(Eigen::Quaterniond::Identity())), 1e-9);
    const Mesh mesh = build_room(shape, seed, 60);
    double nearest_m = 1e9;
    for (size_t i = 0; i < shape.path.size(); i += 25) {
      const Vector3d& p = shape.path[i];
      for (const Vertex& v : mesh.vertices)
        nearest_m = std::min(nearest_m, (Eigen::Vector3f(v.position).cast<double>() - p).norm());
      for (const OccluderBox& box : mesh.occluders) {
        const Vector3d q = box.box_from_room * p;
        EXPECT_GT((q - q.cwiseMax(-box.half).cwiseMin(box.half)).norm(), 0.35) << "sample " << i;
      }
    }
    EXPECT_GT(nearest_m, 0.35);
  }
}

TEST(NextRoomWalk, BothRoomsAreFurnished) {
  const Walk walk = walk_to_next_room(22, 1);
  const RoomShape shape = fit_room(walk.path, 1, walk.doorway);
  int parts[2] = {0, 0};
  for (const Part& part : build_room(shape, 1, 60).parts) {
    if (part.high.x() < 0) ++parts[0];
    if (part.low.x() > 0) ++parts[1];
  }
  EXPECT_GT(parts[0], 40);
  EXPECT_GT(parts[1], 40);
}

TEST(NextRoomWalk, IsRepeatableAndItsSeedMatters) {
  const CameraPath path = walk_to_next_room(22, 1).path, same = walk_to_next_room(22, 1).path;
  const CameraPath other = walk_to_next_room(22, 2).path;
  double difference_m = 0;
  for (const double t : path.times_s()) {
    EXPECT_EQ(path.at(t).translation, same.at(t).translation);
    difference_m = std::max(difference_m, (path.at(t).translation - other.at(t).translation).norm());
  }
  EXPECT_GT(difference_m, 0.05);
}

}  // namespace
}  // namespace rumi::synth
