// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/model/map_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "tests/map_server/synthetic_submaps.h"

namespace rumi::testing {
using namespace rumi::map_server;
namespace {

using Placed = std::map<SubmapKey, PlacedSubmap>;

// Front, back, front: the back submap shares images with both front submaps.
class MapModelTest : public ::testing::Test {
 protected:
  MapModelTest() : world_(make_room(1)), images_(film(world_, walk_round(70, 0.7), {})) {
    add({.key = {1, 1}, .last = 29, .submap_from_world = random_gauge(1), .seed = 1});
    add({.key = {1, -1},
         .kind = SubmapKind::kBack,
         .first = 18,
         .last = 51,
         .keyframe_every = 1,
         .submap_from_world = random_gauge(2),
         .seed = 2});
    add({.key = {1, 2}, .first = 39, .last = 69, .submap_from_world = random_gauge(3), .seed = 3});
  }
  void add(SubmapRecipe recipe) {
    recipe.rotation_noise_deg = recipe.center_noise_m = recipe.depth_noise = 0;
    made_[recipe.key] = make_submap(world_, images_, recipe);
  }
  Placed placed() const {
    Placed placed;
    for (const auto& [key, made] : made_) placed[key] = truly_placed(made);
    return placed;
  }
  int world_point(const LandmarkRef& ref) const { return made_.at(ref.submap).point_of.at(ref.id); }
  // Returns a landmark of the submap that more than two keyframes observe; `skip` of them are passed over.
  const Landmark& well_seen(SubmapKey key, int skip = 0) const {
    for (const auto& [id, landmark] : made_.at(key).submap.landmarks)
      if (landmark.observations.size() > 2 && skip-- == 0) return landmark;
    throw std::logic_error("no such landmark");
  }

  World world_;
  std::vector<Image> images_;
  std::map<SubmapKey, SyntheticSubmap> made_;
  const SubmapKey front1_{1, 1}, back_{1, -1}, front2_{1, 2};
};

const MapModel::Point* point_of(const MapModel& model, const LandmarkRef& ref) {
  for (const MapModel::Point& point : model.points)
    if (std::find(point.landmarks.begin(), point.landmarks.end(), ref) != point.landmarks.end()) return &point;
  return nullptr;
}

TEST_F(MapModelTest, SameTimeIsOneViewAndTheBackSubmapIsBelieved) {
  Placed submaps = placed();
  for (auto& [utime_us, similarity] : submaps[front1_].placement.map_from_submap)
    similarity = Sim3(1, Eigen::Quaterniond::Identity(), {0.1, 0, 0}) * similarity;
  const MapModel model = join(submaps, 1);
  std::map<int64_t, std::set<SubmapKey>> images;
  for (const auto& [key, made] : made_)
    for (const auto& [id, keyframe] : made.submap.keyframes) images[keyframe.utime_us].insert(key);
  ASSERT_EQ(model.views.size(), images.size());
  size_t shared = 0;
  for (size_t v = 0; v < model.views.size(); ++v) {
    const MapModel::View& view = model.views[v];
    if (v > 0) {
      EXPECT_LT(model.views[v - 1].image.utime_us, view.image.utime_us);
    }
    ASSERT_EQ(view.keyframes.size(), images.at(view.image.utime_us).size());
    shared += view.keyframes.size() > 1;
    EXPECT_EQ(images.at(view.image.utime_us).contains(back_), view.keyframes.front().submap == back_);
    const SE3& truth = images_[(view.image.utime_us - 1'000'000) / 100'000].cam_from_world;
    const double expected = images.at(view.image.utime_us) == std::set<SubmapKey>{front1_} ? 0.1 : 0;
    EXPECT_NEAR((view.cam_from_map.center() - truth.center()).norm(), expected, 1e-9);
  }
  EXPECT_EQ(shared, 9u);
  EXPECT_EQ(inconsistency(model), "");
}

TEST_F(MapModelTest, SameTimesOfTwoStreamsAreTwoViews) {
  const size_t views = join(placed(), 1.0F).views.size();
  made_[back_].submap.stream = 1;
  const MapModel model = join(placed(), 1.0F);
  size_t keyframes = 0;
  for (const auto& [key, made] : made_) keyframes += made.submap.keyframes.size();
  EXPECT_LT(views, keyframes);
  EXPECT_EQ(model.views.size(), keyframes);
  for (const MapModel::View& view : model.views) EXPECT_EQ(view.keyframes.size(), 1);
}

TEST_F(MapModelTest, LandmarksAtTheSameKeypointAreOnePoint) {
  const MapModel model = join(placed(), 1);
  EXPECT_EQ(inconsistency(model), "");
  size_t landmarks = 0, joined = 0;
  for (const MapModel::Point& point : model.points) {
    landmarks += point.landmarks.size();
    joined += point.landmarks.size() > 1;
    for (const LandmarkRef& ref : point.landmarks) EXPECT_EQ(world_point(ref), world_point(point.landmarks[0]));
    EXPECT_LT((point.position - world_.points[world_point(point.landmarks[0])]).norm(), 1e-6);
  }
  size_t of_submaps = 0;
  for (const auto& [key, made] : made_) of_submaps += made.submap.landmarks.size();
  EXPECT_EQ(landmarks, of_submaps);
  EXPECT_GT(joined, 300u);
  for (const MapModel::View& view : model.views)
    for (const KeyframeRef& ref : view.keyframes) {
      const Keyframe& keyframe = *made_.at(ref.submap).submap.keyframe(ref.id);
      for (size_t k = 0; k < keyframe.landmark_ids.size(); ++k)
        if (const int id = keyframe.landmark_ids[k]; id != kNone) {
          ASSERT_NE(view.points[k], kNone);
          const auto& refs = model.points[view.points[k]].landmarks;
          EXPECT_TRUE(std::count(refs.begin(), refs.end(), LandmarkRef{ref.submap, id}));
        }
    }
}

TEST_F(MapModelTest, JoinedAndSplitAllIsWhereItWas) {
  const Placed before = placed();
  const auto after = split(join(before, 1), before);
  ASSERT_EQ(after.size(), 3u);
  for (const auto& [key, made] : made_) {
    const Placement& placement = after.at(key);
    for (const auto& [id, keyframe] : made.submap.keyframes) {
      const Sim3Error error = error_of(placement.map_from_submap.at(keyframe.utime_us),
                                       made.submap_from_world.inverse(), keyframe.cam_from_submap.center(), 1);
      EXPECT_LT(error.rotation_deg, 1e-5);
      EXPECT_LT(std::abs(error.log_scale), 1e-9);
      EXPECT_LT(error.translation, 1e-9);
    }
    for (const auto& [id, landmark] : made.submap.landmarks)
      EXPECT_LT((placement.position_in_map(made.submap, landmark) - world_.points[made.point_of.at(id)]).norm(), 1e-6);
    for (const auto& [id, into] : placement.fused) EXPECT_EQ(world_point(into), made.point_of.at(id));
    const Submap in_map = place(made.submap, placement);
    for (const auto& [utime_us, frame] : in_map.frames) {
      const SE3& truth = images_[(utime_us - 1'000'000) / 100'000].cam_from_world;
      EXPECT_LT((in_map.cam_from_submap(frame).center() - truth.center()).norm(), 1e-9);
      EXPECT_LT(rotation_error_deg(in_map.cam_from_submap(frame), truth), 1e-5);
    }
  }
}

TEST_F(MapModelTest, ASecondRoundChangesNothing) {
  Placed submaps = placed();
  const auto once = split(join(submaps, 1), submaps);
  for (const auto& [key, placement] : once) submaps[key].placement = placement;
  const MapModel model = join(submaps, 1);
  EXPECT_EQ(inconsistency(model), "");
  const auto twice = split(model, submaps);
  for (const auto& [key, placement] : once) {
    EXPECT_EQ(twice.at(key).fused, placement.fused);
    ASSERT_EQ(twice.at(key).landmarks.size(), placement.landmarks.size());
    for (const auto& [id, position] : placement.landmarks)
      EXPECT_LT((twice.at(key).landmarks.at(id) - position).norm(), 1e-9);
  }
}

TEST_F(MapModelTest, NothingIsFusedIntoWhatIsFusedItself) {
  const Placed submaps = placed();
  const auto placements = split(join(submaps, 1), submaps);
  size_t fused = 0;
  for (const auto& [key, placement] : placements)
    for (const auto& [id, into] : placement.fused) {
      ++fused;
      EXPECT_FALSE(placements.at(into.submap).fused.contains(into.id));
      EXPECT_NE(into, (LandmarkRef{key, id}));
    }
  EXPECT_GT(fused, 300u);
}

// A part of the map contains a landmark at its edge that is fused into one outside the part.
TEST_F(MapModelTest, WhatLiesOutsideStandsForWhatIsFusedIntoIt) {
  Placed submaps = placed();
  const LandmarkRef outside{{1, 9}, 7};
  PlacedSubmap& edge = submaps[front1_];
  edge.fixed = true;
  for (const auto& [id, landmark] : edge.submap->landmarks) edge.placement.fused[id] = outside;
  const auto placements = split(join(submaps, 1), submaps);
  int fused = 0;
  for (const auto& [id, into] : placements.at(back_).fused) {
    EXPECT_NE(into.submap, front1_);
    fused += into == outside;
  }
  EXPECT_GT(fused, 50);
  submaps.erase(back_);
  EXPECT_TRUE(same_place(split(join(submaps, 1), submaps).at(front1_), edge.placement));
}

TEST_F(MapModelTest, FusedLandmarksAreOnePoint) {
  Placed submaps = placed();
  const Landmark& in_front = well_seen(front1_);
  const Landmark& in_other = well_seen(front2_);
  submaps[front1_].placement.fused[in_front.id] = {front2_, in_other.id};
  const MapModel model = join(submaps, 1);
  EXPECT_EQ(inconsistency(model), "");
  const MapModel::Point* point = point_of(model, {front1_, in_front.id});
  ASSERT_TRUE(point);
  EXPECT_EQ(point, point_of(model, {front2_, in_other.id}));
  EXPECT_GE(point->observations.size(), in_front.observations.size() + in_other.observations.size());
}

TEST_F(MapModelTest, OfTwoKeypointsOfAViewOneIsDropped) {
  Placed submaps = placed();
  // Takes two landmarks that one image observes at different keypoints.
  const Submap& front = made_[front1_].submap;
  const Keyframe& keyframe = front.keyframes.begin()->second;
  std::vector<int> ids;
  for (int id : keyframe.landmark_ids)
    if (id != kNone && ids.size() < 2) ids.push_back(id);
  submaps[front1_].placement.fused[ids[1]] = {front1_, ids[0]};
  const MapModel model = join(submaps, 1);
  EXPECT_EQ(inconsistency(model), "");
  const MapModel::Point* point = point_of(model, {front1_, ids[1]});
  EXPECT_EQ(point, point_of(model, {front1_, ids[0]}));
  EXPECT_EQ(std::count_if(model.views[0].points.begin(), model.views[0].points.end(),
                          [&](int p) { return p != kNone && &model.points[p] == point; }),
            1);
}

// A placement may be older than its submap: its entries for removed elements must have no effect.
TEST_F(MapModelTest, PlacementsOfWhatIsGoneDoNoHarm) {
  Placed submaps = placed();
  Submap& front = made_[front1_].submap;
  const Landmark removed = well_seen(front1_), other = well_seen(front1_, 1);
  Placement& placement = submaps[front1_].placement;
  placement.landmarks[removed.id] = {1e6, 1e6, 1e6};
  placement.fused[removed.id] = {back_, 3};
  placement.fused[other.id] = {front1_, removed.id};
  submaps[back_].placement.fused[5] = {{9, 9}, 1};  // a submap that does not exist
  front.remove_landmark(removed.id);
  const int64_t gone_us = front.keyframes.at(4).utime_us;
  front.remove_keyframe(4, 3);
  const MapModel model = join(submaps, 1);
  EXPECT_EQ(inconsistency(model), "");
  EXPECT_FALSE(point_of(model, {front1_, removed.id}));
  EXPECT_TRUE(point_of(model, {front1_, other.id}));
  const auto after = split(model, submaps);
  EXPECT_FALSE(after.at(front1_).landmarks.contains(removed.id));
  EXPECT_FALSE(after.at(front1_).fused.contains(removed.id));
  EXPECT_FALSE(after.at(front1_).map_from_submap.contains(gone_us));
  EXPECT_LT(
      (after.at(front1_).position_in_map(front, other) - world_.points[made_[front1_].point_of.at(other.id)]).norm(),
      1e-6);
}

TEST_F(MapModelTest, WhatIsSeenOnceOrNeverFollowsItsKeyframe) {
  Submap& front = made_[front1_].submap;
  Landmark once = well_seen(front1_), never = well_seen(front1_, 1);
  for (size_t i = 1; i < once.observations.size(); ++i)
    front.remove_observation(once.id, once.observations[i].keyframe_id);
  for (const Observation& o : never.observations) front.remove_observation(never.id, o.keyframe_id);
  made_.erase(back_);  // because it observes them too
  made_.erase(front2_);
  const Placed submaps = placed();
  const auto after = split(join(submaps, 1), submaps);
  for (int id : {once.id, never.id}) {
    EXPECT_FALSE(after.at(front1_).landmarks.contains(id));
    EXPECT_LT(
        (after.at(front1_).position_in_map(front, *front.landmark(id)) - world_.points[made_[front1_].point_of.at(id)])
            .norm(),
        1e-6);
  }
}

// A detector may find the same pixel in two octaves.
TEST_F(MapModelTest, TwoKeypointsAtOnePixelStayTwo) {
  const SubmapKey keys[] = {front1_, back_};
  for (const SubmapKey& key : keys)
    for (auto& [id, keyframe] : made_[key].submap.keyframes) {
      if (keyframe.utime_us != images_[18].utime_us) continue;
      Features features = *keyframe.features;
      features.undistorted[1] = features.undistorted[0];
      features.keypoints[1].pixel = features.keypoints[0].pixel;
      keyframe.features = std::make_shared<Features>(features);
    }
  const MapModel model = join(placed(), 1);
  for (const MapModel::Point& point : model.points)
    for (const LandmarkRef& ref : point.landmarks) EXPECT_EQ(world_point(ref), world_point(point.landmarks[0]));
}

// front_tracker moves keypoints to refine them, while ruminator's stay where the detector found them.
TEST_F(MapModelTest, KeypointsThatFrontTrackerMovedAreTheSameAndBelieved) {
  const Placed before = placed();
  const size_t points = join(before, 1).points.size();
  for (auto& [id, keyframe] : made_[front1_].submap.keyframes) {
    Features features = *keyframe.features;
    for (Eigen::Vector2f& pixel : features.undistorted) pixel.x() += 3;
    keyframe.features = std::make_shared<Features>(features);
  }
  const MapModel model = join(placed(), 1);
  EXPECT_EQ(model.points.size(), points);
  int shared = 0;
  for (const MapModel::View& view : model.views)
    for (const KeyframeRef& ref : view.keyframes)
      if (ref.submap == front1_) {
        EXPECT_EQ(view.features, made_[front1_].submap.keyframe(ref.id)->features);
        shared += view.keyframes.size() > 1;
      }
  EXPECT_GT(shared, 2);
}

TEST_F(MapModelTest, ObserveForgetAndFuseKeepBothDirections) {
  MapModel model = join(placed(), 1);
  const int view = 5, point = *std::find_if(model.views[view].points.begin(), model.views[view].points.end(),
                                            [](int p) { return p != kNone; });
  const size_t count = model.points[point].observations.size();
  EXPECT_FALSE(model.observe(point, view, 0));  // this view observes the point already
  model.forget(point, view);
  EXPECT_EQ(model.points[point].observations.size(), count - 1);
  model.forget(point, view);
  EXPECT_EQ(model.points[point].observations.size(), count - 1);
  EXPECT_EQ(inconsistency(model), "");
  const auto taken =
      std::find_if(model.views[view].points.begin(), model.views[view].points.end(), [](int p) { return p != kNone; });
  EXPECT_FALSE(model.observe(point, view, static_cast<int>(taken - model.views[view].points.begin())));
  EXPECT_EQ(inconsistency(model), "");
  const int other = *taken;
  const size_t landmarks = model.points[other].landmarks.size() + model.points[point].landmarks.size();
  model.fuse(other, point);
  EXPECT_TRUE(model.points[point].observations.empty());
  EXPECT_TRUE(model.points[point].landmarks.empty());
  EXPECT_EQ(model.points[other].landmarks.size(), landmarks);
  EXPECT_EQ(inconsistency(model), "");
}

TEST(MapModel, OfNothing) {
  EXPECT_TRUE(join({}, 1).views.empty());
  EXPECT_TRUE(split({}, {}).empty());
  const Submap empty;
  const Placed submaps{{{1, 1}, {&empty, {}}}};
  const MapModel model = join(submaps, 1);
  EXPECT_TRUE(model.points.empty());
  EXPECT_EQ(split(model, submaps).size(), 1u);
}

}  // namespace
}  // namespace rumi::testing
