// SPDX-License-Identifier: BSD-3-Clause
#include "synth/repeating_walks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "synth/options.h"
#include "synth/rasterizer.h"

namespace rumi::synth {
namespace {

using Eigen::Vector3d;

struct Scene {
  const char* name;
  std::function<Walk(double, uint64_t)> walk;
  double seconds;
};
const Scene kScenes[] = {{"twin rooms", walk_to_twin_room, 22},
                         {"storeys", walk_up_storeys, 54},
                         {"doors", walk_past_doors, 36},
                         {"square", walk_round_square, 44}};

RoomShape shape_of(const Walk& walk) { return fit_cell(walk.path, *walk.repeats, walk.doorway); }

double difference(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b, cv::NORM_L1) / static_cast<double>(a.total());
}

TEST(RepeatingWalks, NothingStandsInTheWay) {
  for (const Scene& scene : kScenes) {
    const Walk walk = scene.walk(scene.seconds, 2);
    const RoomShape shape = shape_of(walk);
    const Mesh mesh = repeat(build_room(shape, 2, 60), walk.repeats->copies, 1, 2);
    double nearest_m = 1e9;
    for (size_t i = 0; i < walk.path.times_s().size(); i += 60) {
      const Vector3d at = walk.path.at(walk.path.times_s()[i]).translation;
      const double t = walk.path.times_s()[i] - walk.path.times_s().front();
      bool blank = false;  // the lift passes through floors
      for (const HardPassage& hard : walk.hard) blank = blank || (t >= hard.at_s && t <= hard.at_s + hard.for_s);
      if (blank) continue;
      for (const Vertex& v : mesh.vertices)
        nearest_m = std::min(nearest_m, (Eigen::Vector3f(v.position).cast<double>() - at).norm());
    }
    EXPECT_GT(nearest_m, 0.35) << scene.name;
  }
}

// A camera sees the same at the same place of each copy.
TEST(RepeatingWalks, TheCopiesAreSeenAlike) {
  const Camera camera = default_synth_camera(160, 120);
  for (const Scene& scene : kScenes) {
    const Walk walk = scene.walk(scene.seconds, 3);
    const std::vector<SE3>& copies = walk.repeats->copies;
    const Mesh cell = build_room(shape_of(walk), 3, camera.fx);  // unlit, which is quicker
    Rasterizer exact(repeat(cell, copies, 1, 3), camera), alike(repeat(cell, copies, 0.5, 3), camera);
    const SE3 pose = walk.path.at(walk.path.times_s().front() + 1);  // in the first copy, or beside it
    const size_t middle = copies.size() / 2;
    const SE3 there = copies[middle] * copies[middle - 1].inverse() * pose;
    cv::Mat one, other, changed, changed_there;
    exact.draw(pose.inverse(), 0, &one);
    exact.draw(there.inverse(), 0, &other);
    alike.draw(pose.inverse(), 0, &changed);
    alike.draw(there.inverse(), 0, &changed_there);
    EXPECT_LT(difference(one, other), 2) << scene.name;
    EXPECT_GT(difference(changed, changed_there), 5) << scene.name;
  }
}

TEST(RepeatingWalks, TheyLeadFromCopyToCopyWhileNothingIsSeen) {
  const Walk storeys = walk_up_storeys(54, 1);
  ASSERT_EQ(storeys.hard.size(), 2u);
  for (const HardPassage& lift : storeys.hard) {
    const double begin_s = storeys.path.times_s().front() + lift.at_s;
    const SE3 before = storeys.path.at(begin_s), after = storeys.path.at(begin_s + lift.for_s);
    EXPECT_NEAR((after.translation - before.translation).z(), 3.2, 0.4);
  }
  const Walk doors = walk_past_doors(36, 1);
  EXPECT_GT((doors.path.at(1036).translation - doors.path.at(1000).translation).x(), 4 * kDoorEvery_m);
  EXPECT_EQ(walk_round_square(44, 1).repeats->copies.size(), 4u);
}

TEST(RepeatingWalks, ThePathIsSmoothAndItsSeedMatters) {
  for (const Scene& scene : kScenes) {
    const CameraPath path = scene.walk(scene.seconds, 1).path, other = scene.walk(scene.seconds, 2).path;
    double step_m = 0, difference_m = 0;
    for (double t = 1000; t < 999 + scene.seconds; t += 0.05) {
      step_m = std::max(step_m, (path.at(t + 0.05).translation - path.at(t).translation).norm());
      difference_m = std::max(difference_m, (path.at(t).translation - other.at(t).translation).norm());
    }
    EXPECT_LT(step_m, 0.15) << scene.name;
    EXPECT_GT(difference_m, 0.05) << scene.name;
  }
}

}  // namespace
}  // namespace rumi::synth
