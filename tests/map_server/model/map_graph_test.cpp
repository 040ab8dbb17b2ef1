// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/model/map_graph.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "tests/map_server/synthetic_submaps.h"

namespace rumi::testing {
using namespace rumi::map_server;
namespace {

using Placed = std::map<SubmapKey, PlacedSubmap>;

// A chain of submaps round the room whose scales drift, each placed at the end of the previous one. The last submap
// sees the place where the first one begins.
class MapGraphTest : public ::testing::Test {
 protected:
  static constexpr int kSubmaps = 4, kImages = 120, kOverlap = 6;

  MapGraphTest() : world_(make_room(1)), images_(film(world_, walk_round(kImages, 1), {})) {
    const int length = kImages / kSubmaps;
    for (int s = 0; s < kSubmaps; ++s) {
      SubmapRecipe recipe{.key = {1, s + 1}, .first = s * length};
      recipe.last = std::min(kImages - 1, (s + 1) * length + kOverlap - 1);
      recipe.submap_from_world = random_gauge(static_cast<unsigned>(s) + 5);
      recipe.seed = static_cast<unsigned>(s) + 1;
      recipe.rotation_noise_deg = recipe.center_noise_m = 0;
      recipe.distortion = drift(images_, recipe.first, 0.002);
      made_[recipe.key] = make_submap(world_, images_, recipe);
      moved_[recipe.key] = recipe.distortion;
    }
    for (int s = 1; s < kSubmaps; ++s) add_joints({1, s}, {1, s + 1});
    close();
    place();
  }

  static int64_t utime_us(int image) { return 1'000'000 + 100'000 * image; }

  // Adds joints at the images of which both submaps have a keyframe. Their cameras are the same, so only the scales
  // differ.
  void add_joints(SubmapKey a, SubmapKey b) {
    LinkJoints& joints = links_.emplace_back();
    for (const auto& [id_a, in_a] : made_[a].submap.keyframes)
      for (const auto& [id_b, in_b] : made_[b].submap.keyframes)
        if (in_a.utime_us == in_b.utime_us) joints.push_back(joint({a, id_a}, {b, id_b}, SE3()));
  }
  // Closes the loop: adds joints from the first keyframe of the chain to its last three.
  void close() {
    const SubmapKey last{1, kSubmaps};
    const int newest = made_[last].submap.keyframes.rbegin()->first;
    LinkJoints& joints = links_.emplace_back();
    for (int id = newest - 2; id <= newest; ++id)
      joints.push_back(joint({{1, 1}, 0}, {last, id}, truth(last, id) * truth({1, 1}, 0).inverse()));
  }
  KeyframeJoint joint(KeyframeRef a, KeyframeRef b, const SE3& b_from_a_m) const {
    const double unit_b = scale_at(b), scale = unit_b / scale_at(a);
    return {a, b, Sim3(scale, b_from_a_m.rotation, unit_b * b_from_a_m.translation), 0.002, 0.01 * unit_b, 0.01};
  }
  // Returns the length of a metre in the submap's unit, at a keyframe.
  double scale_at(KeyframeRef ref) const {
    const int image = image_of(ref.submap, ref.id);
    return made_.at(ref.submap).submap_from_world.scale * moved_.at(ref.submap).at(image).scale;
  }
  int image_of(SubmapKey key, int id) const {
    return static_cast<int>((made_.at(key).submap.keyframe(id)->utime_us - 1'000'000) / 100'000);
  }
  SE3 truth(SubmapKey key, int id) const { return images_[image_of(key, id)].cam_from_world; }

  // Places each submap rigidly by the first image that it shares with the previous one, so that later keyframes are
  // wrong by the drift.
  void place() {
    Sim3 map_from_submap = made_[{1, 1}].submap_from_world.inverse();
    for (int s = 1; s <= kSubmaps; ++s) {
      const SubmapKey key{1, s};
      placed_[key] = {&made_[key].submap, rigid_placement(made_[key].submap, map_from_submap)};
      if (s == kSubmaps) break;
      const Submap &a = made_[key].submap, &b = made_[{1, s + 1}].submap;
      const SE3& in_b = b.keyframes.at(0).cam_from_submap;
      for (const auto& [id, in_a] : a.keyframes) {
        if (in_a.utime_us != b.keyframes.at(0).utime_us) continue;
        const double scale = scale_at({key, id}) / scale_at({{1, s + 1}, 0});
        const Eigen::Quaterniond turn = in_a.cam_from_submap.rotation.conjugate() * in_b.rotation;
        const Sim3 a_from_b(scale, turn, in_a.cam_from_submap.center() - scale * (turn * in_b.center()));
        map_from_submap = map_from_submap * a_from_b;
      }
    }
  }

  MapGraphReport bend(SubmapKey anchor, bool may_be_wrong = false) {
    return map_server::bend(
        links_, [=](size_t) { return may_be_wrong; }, anchor, {}, &placed_);
  }

  PathError error() const {
    std::vector<Eigen::Vector3d> estimate, truths;
    for (const auto& [key, placed] : placed_)
      for (const auto& [id, keyframe] : placed.submap->keyframes) {
        estimate.push_back(placed.placement.cam_from_map(keyframe).center());
        truths.push_back(truth(key, id).center());
      }
    return path_error(estimate, truths);
  }

  World world_;
  std::vector<Image> images_;
  std::map<SubmapKey, SyntheticSubmap> made_;
  std::map<SubmapKey, Distortion> moved_;
  std::vector<LinkJoints> links_;
  Placed placed_;
};

TEST_F(MapGraphTest, SpreadsTheDriftOverTheChain) {
  const PathError before = error();
  const MapGraphReport report = bend({1, 1});
  const PathError after = error();
  std::printf("ATE %.1f -> %.1f mm, worst %.1f -> %.1f mm; chi2 of the closing joint %.1f\n", 1000 * before.rmse,
              1000 * after.rmse, 1000 * before.worst, 1000 * after.worst, report.joint_chi2.back().back());
  ASSERT_TRUE(report.bent);
  ASSERT_EQ(report.joint_chi2.size(), links_.size());
  EXPECT_GT(before.rmse, 0.05);
  EXPECT_LT(after.rmse, 0.25 * before.rmse);
}

TEST_F(MapGraphTest, TheAnchorsFirstKeyframeStays) {
  const Placement before = placed_[{1, 2}].placement;
  const Submap& anchor = made_[{1, 2}].submap;
  ASSERT_TRUE(bend({1, 2}).bent);
  const int64_t first_us = anchor.keyframes.at(0).utime_us;
  const Sim3Error moved = error_of(placed_[{1, 2}].placement.at(first_us), before.at(first_us),
                                   anchor.keyframes.at(0).cam_from_submap.center(), 1);
  EXPECT_LT(moved.rotation_deg, 1e-5);
  EXPECT_LT(std::abs(moved.log_scale), 1e-9);
  EXPECT_LT(moved.translation, 1e-9);
}

TEST_F(MapGraphTest, AWrongJointDoesNotTearTheMap) {
  const Placed before = placed_;
  bend({1, 1});
  Placed good = std::exchange(placed_, before);
  const KeyframeJoint wrong = joint({{1, 1}, 5}, {{1, 3}, 5}, SE3(so3_exp({0, 2, 0}), Eigen::Vector3d(1, 0, 1)));
  links_.push_back({wrong});
  const MapGraphReport report = bend({1, 1});
  const double with_wrong = error().rmse;
  std::swap(good, placed_);
  std::printf("ATE %.1f mm, with a wrong joint %.1f mm; its chi2 %.0f\n", 1000 * error().rmse, 1000 * with_wrong,
              report.joint_chi2.back().back());
  EXPECT_LT(with_wrong, 0.1);
  EXPECT_GT(report.joint_chi2.back().back(), 1000);
  EXPECT_EQ(std::count(report.is_wrong.begin(), report.is_wrong.end(), true), 0) << "none may be wrong";
}

TEST_F(MapGraphTest, WrongLinksAreFoundAtOnceAndCountForNothing) {
  const Placed before = placed_;
  bend({1, 1});
  const Placed good = std::exchange(placed_, before);
  for (const int keyframe : {2, 5, 8})
    links_.push_back({joint({{1, 1}, keyframe}, {{1, 3}, keyframe},
                            SE3(so3_exp({0, 0.3 * keyframe, 0}), Eigen::Vector3d(1, 0, keyframe)))});
  const MapGraphReport report = bend({1, 1}, true);
  ASSERT_EQ(report.is_wrong.size(), links_.size());
  for (size_t i = 0; i < links_.size(); ++i) EXPECT_EQ(report.is_wrong[i], i + 3 >= links_.size()) << i;
  const double with_wrong = error().rmse;
  placed_ = good;
  EXPECT_NEAR(with_wrong, error().rmse, 1e-3);
}

TEST_F(MapGraphTest, AdjustedLandmarksFollowTheirKeyframes) {
  Placement& placement = placed_[{1, 3}].placement;
  const Submap& submap = made_[{1, 3}].submap;
  for (const auto& [id, landmark] : submap.landmarks)
    placement.landmarks[id] = placement.position_in_map(submap, landmark) + Eigen::Vector3d(0, 0.01, 0);
  placement.landmarks[123456] = Eigen::Vector3d(1, 2, 3);  // the landmark does not exist any more
  ASSERT_TRUE(bend({1, 1}).bent);
  EXPECT_FALSE(placement.landmarks.contains(123456));
  double worst_px = 0;
  for (const auto& [id, position] : placement.landmarks) {
    const Observation& o = submap.landmark(id)->observations.front();
    const Keyframe& keyframe = *submap.keyframe(o.keyframe_id);
    const Eigen::Vector3d moved = placement.cam_from_map(keyframe) * position;
    worst_px = std::max(worst_px, (submap.camera.project_undistorted(moved) -
                                   keyframe.features->undistorted[o.keypoint_index].cast<double>())
                                      .norm());
  }
  EXPECT_LT(worst_px, 30);  // an error of 1 cm at a distance of 1 m would be 5 px
}

TEST_F(MapGraphTest, NothingToBend) {
  const Placed before = placed_;
  links_.clear();
  EXPECT_TRUE(bend({1, 1}).joint_chi2.empty());
  for (const auto& [key, placed] : before)
    for (const auto& [utime_us, similarity] : placed.placement.map_from_submap)
      EXPECT_LT((similarity.translation - placed_[key].placement.map_from_submap.at(utime_us).translation).norm(),
                1e-6);
  const Submap empty;
  Placed nothing{{{1, 1}, {&empty, {}}}};
  placed_ = nothing;
  EXPECT_FALSE(bend({1, 1}).bent);
}

// Values that are not finite must not spread to the placements.
TEST_F(MapGraphTest, NumbersThatAreNoneChangeNothing) {
  made_[{1, 2}].submap.keyframes.at(3).cam_from_submap.translation.setConstant(NAN);
  for (auto& [id, landmark] : made_[{1, 3}].submap.landmarks)
    if (id % 2) landmark.position.setConstant(NAN);
  bend({1, 1});
  for (const auto& [key, placed] : placed_)
    for (const auto& [utime_us, similarity] : placed.placement.map_from_submap) EXPECT_TRUE(similarity.is_finite());
}

}  // namespace
}  // namespace rumi::testing
