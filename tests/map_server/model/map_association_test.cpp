// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/model/map_association.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <set>

#include "map_server/model/map_bundle.h"
#include "tests/map_server/synthetic_submaps.h"

namespace rumi::testing {
using namespace rumi::map_server;
namespace {

// Two submaps of the same walk at different times, without any image in common.
class Twice {
 public:
  explicit Twice(World world, double point_share = 0.8) : world_(std::move(world)) {
    CameraPath path = walk_round(30, 0.3);
    for (const SE3& pose : walk_round(30, 0.3))  // the second walk is slightly beside the first
      path.push_back(SE3(so3_exp({0.02, -0.03, 0.05}), Eigen::Vector3d(0.08, 0.05, -0.05)) * pose);
    images_ = film(world_, path, {});
    for (int s = 0; s < 2; ++s) {
      SubmapRecipe recipe{.key = {1, s + 1}, .first = 30 * s, .last = 30 * s + 29};
      recipe.submap_from_world = random_gauge(static_cast<unsigned>(s) + 1);
      recipe.seed = static_cast<unsigned>(s) + 1;
      recipe.point_share = point_share;
      made_[recipe.key] = make_submap(world_, images_, recipe);
      placed_[recipe.key] = truly_placed(made_[recipe.key]);
    }
  }

  // Joins the two submaps, with the second one displaced by `off`.
  MapModel model(const Sim3& off) {
    for (auto& [utime_us, similarity] : placed_[{1, 2}].placement.map_from_submap) similarity = off * similarity;
    return join(placed_, 1);
  }

  int world_point(const LandmarkRef& ref) const { return made_.at(ref.submap).point_of.at(ref.id); }
  int seen_point(const MapModel& model, const MapModel::Observation& o) const {
    return images_[(model.views[o.view].image.utime_us - 1'000'000) / 100'000].point_of[o.keypoint];
  }

  struct Score {
    int common = 0;            // world points that both submaps have
    int right = 0, wrong = 0;  // points with several landmarks, which are or are not the same world point
    int right_seen = 0, wrong_seen = 0;
  };
  Score score(const MapModel& model) const {
    Score score;
    std::set<int> first;
    for (const auto& [id, p] : made_.at({1, 1}).point_of) first.insert(p);
    for (const auto& [id, p] : made_.at({1, 2}).point_of) score.common += static_cast<int>(first.count(p));
    for (const MapModel::Point& point : model.points) {
      std::set<int> of_world;
      for (const LandmarkRef& ref : point.landmarks) of_world.insert(world_point(ref));
      if (point.landmarks.size() > 1) ++(of_world.size() == 1 ? score.right : score.wrong);
      for (const MapModel::Observation& o : point.observations)
        ++(of_world.contains(seen_point(model, o)) ? score.right_seen : score.wrong_seen);
    }
    return score;
  }

 private:
  World world_;
  std::vector<Image> images_;
  std::map<SubmapKey, SyntheticSubmap> made_;
  std::map<SubmapKey, PlacedSubmap> placed_;
};

// Returns a rotation about the middle of the room, followed by a shift.
Sim3 off_by(double rotation_deg, double distance_m, double scale = 1) {
  const Eigen::Vector3d axis = Eigen::Vector3d(1, 2, 0.5).normalized();
  return {scale, so3_exp(rotation_deg * M_PI / 180 * axis), distance_m * Eigen::Vector3d(0.6, 0, -0.8)};
}

TEST(MapAssociation, FindsWhatIsTheSame) {
  for (const auto& [rotation_deg, distance_m] : {std::pair{0.0, 0.0}, {0.2, 0.01}, {0.4, 0.02}}) {
    Twice twice(make_room(3));
    MapModel model = twice.model(off_by(rotation_deg, distance_m));
    const AssociationReport report = associate({}, {}, &model);
    const Twice::Score score = twice.score(model);
    std::printf(
        "off by %.1f deg %.0f mm: %d fused, %d right, %d wrong, of %d; %d new observations; %d right in all, %d "
        "wrong\n",
        rotation_deg, 1000 * distance_m, report.fused, score.right, score.wrong, score.common, report.observed,
        score.right_seen, score.wrong_seen);
    EXPECT_EQ(inconsistency(model), "");
    EXPECT_EQ(report.fused, score.right + score.wrong);
    EXPECT_GT(score.right, 0.6 * score.common);
    EXPECT_GE(score.right, 0.99 * (score.right + score.wrong));
    EXPECT_GE(score.right_seen, 0.99 * (score.right_seen + score.wrong_seen));
  }
}

TEST(MapAssociation, AndAdjustmentBringTogetherWhatWasApart) {
  Twice twice(make_room(4));
  MapModel model = twice.model(off_by(0.4, 0.02, 1.01));
  associate({}, {}, &model);
  const MapBundleReport apart = adjust_map({}, {}, &model);
  AssociationOptions narrow;
  narrow.radius_px = 5;
  associate(narrow, {}, &model);
  const MapBundleReport together = adjust_map({}, {}, &model);
  const Twice::Score score = twice.score(model);
  std::printf("%d fused of %d, %d wrong; outliers %d, then %d; rmse %.2f\n", score.right, score.common, score.wrong,
              apart.outliers, together.outliers, together.rmse);
  EXPECT_GT(score.right, 0.8 * score.common);
  EXPECT_GE(score.right, 0.99 * (score.right + score.wrong));
  EXPECT_LT(together.rmse, 1);
}

// Each point has an identical twin 3 cm away, and the images show both.
TEST(MapAssociation, NeverFusesWhatOneImageSeesApart) {
  World world = make_room(5, 1000);
  for (size_t i = 0, count = world.points.size(); i < count; ++i) {
    world.points.push_back(world.points[i] + Eigen::Vector3d(0.02, 0.02, -0.01));
    world.descriptors.push_back(world.descriptors[i]);
    world.octave0_distances.push_back(world.octave0_distances[i]);
  }
  Twice twice(world, 1.0);
  MapModel model = twice.model(off_by(0.2, 0.01));
  associate({}, {}, &model);
  const Twice::Score score = twice.score(model);
  std::printf("twins: %d right, %d wrong, of %d\n", score.right, score.wrong, score.common);
  EXPECT_EQ(inconsistency(model), "");
  for (const MapModel::Point& point : model.points) {
    std::set<std::pair<SubmapKey, int>> of_submap;
    for (const LandmarkRef& ref : point.landmarks)
      EXPECT_TRUE(of_submap.insert({ref.submap, twice.world_point(ref) % 1000}).second);
  }
  EXPECT_GT(score.right, score.wrong);  // no more than that, because nobody can tell a point from its twin
}

TEST(MapAssociation, FindsNothingWhereNothingIs) {
  MapModel empty;
  EXPECT_EQ(associate({}, {}, &empty).fused, 0);
  Twice twice(make_room(6));
  MapModel model = twice.model(off_by(0, 3));  // far from the true position
  const AssociationReport report = associate({}, {}, &model);
  const Twice::Score score = twice.score(model);
  EXPECT_LE(score.wrong + score.right, 3);
  EXPECT_LE(report.fused, 3);
}

TEST(MapAssociation, NumbersThatAreNoneAreLeftAlone) {
  Twice twice(make_room(7));
  MapModel model = twice.model(off_by(0, 0));
  for (size_t p = 0; p < model.points.size(); p += 10) model.points[p].position.setConstant(p % 20 ? NAN : INFINITY);
  for (int k = 0; k < 3; ++k) model.views[k].cam_from_map.translation.setConstant(NAN);
  associate({}, {}, &model);
  const Twice::Score score = twice.score(model);
  EXPECT_GE(score.right, 0.99 * (score.right + score.wrong));
  for (size_t p = 0; p < model.points.size(); p += 10) EXPECT_LE(model.points[p].landmarks.size(), 1u);
}

}  // namespace
}  // namespace rumi::testing
