// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/model/map_bundle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "tests/map_server/synthetic_submaps.h"

namespace rumi::testing {
using namespace rumi::map_server;
namespace {

// A model without errors, of a front and a back submap that share images.
class MapBundleTest : public ::testing::Test {
 protected:
  explicit MapBundleTest(double wrong_observations = 0) : world_(make_room(1)) {
    images_ = film(world_, walk_round(50, 0.5), {});
    SubmapRecipe front{.last = 29}, back{.key = {1, -1}, .kind = SubmapKind::kBack, .first = 18, .last = 49};
    back.keyframe_every = 2;
    back.seed = 2;
    for (SubmapRecipe* recipe : {&front, &back}) {
      recipe->rotation_noise_deg = recipe->center_noise_m = recipe->depth_noise = 0;
      recipe->wrong_observations = wrong_observations;
      made_[recipe->key] = make_submap(world_, images_, *recipe);
      placed_[recipe->key] = truly_placed(made_[recipe->key]);
    }
    model_ = join(placed_, 1);
  }

  void disturb(double rotation_deg, double center_m, double point_m) {
    std::mt19937 rng(7);
    std::normal_distribution<double> n(0, 1);
    const auto normal3 = [&](double sigma) {
      const double x = n(rng), y = n(rng), z = n(rng);
      return Eigen::Vector3d(sigma * x, sigma * y, sigma * z);
    };
    for (MapModel::View& view : model_.views) {
      SE3 map_from_cam = view.cam_from_map.inverse();
      map_from_cam.rotation = map_from_cam.rotation * so3_exp(normal3(rotation_deg * M_PI / 180));
      map_from_cam.translation += normal3(center_m);
      view.cam_from_map = map_from_cam.inverse();
    }
    for (MapModel::Point& point : model_.points) point.position += normal3(point_m);
  }

  PathError error() const {
    std::vector<Eigen::Vector3d> estimate, truth;
    for (const MapModel::View& view : model_.views) {
      estimate.push_back(view.cam_from_map.center());
      truth.push_back(images_[(view.image.utime_us - 1'000'000) / 100'000].cam_from_world.center());
    }
    return path_error(estimate, truth);
  }

  int world_point(const MapModel::Point& point) const {
    return made_.at(point.landmarks[0].submap).point_of.at(point.landmarks[0].id);
  }
  int seen_point(const MapModel::Observation& o) const {
    return images_[(model_.views[o.view].image.utime_us - 1'000'000) / 100'000].point_of[o.keypoint];
  }

  World world_;
  std::vector<Image> images_;
  std::map<SubmapKey, SyntheticSubmap> made_;
  std::map<SubmapKey, PlacedSubmap> placed_;
  MapModel model_;
};

class MapBundleWithOutliersTest : public MapBundleTest {
 protected:
  MapBundleWithOutliersTest() : MapBundleTest(0.05) {}
};

TEST_F(MapBundleWithOutliersTest, FindsTheTruthAgain) {
  const MapModel truth = model_;
  adjust_map({}, {}, &model_);
  const double best_m = error().rmse;  // the error that the noise of the pixels leaves
  model_ = truth;
  disturb(0.5, 0.03, 0.05);
  const double before_m = error().rmse;
  const MapBundleReport report = adjust_map({}, {}, &model_);
  const double after_m = error().rmse;
  int right = 0, wrong = 0;
  for (const MapModel::Point& point : model_.points)
    for (const MapModel::Observation& o : point.observations) {
      const bool is_right = world_point(point) == seen_point(o);
      right += is_right;
      wrong += !is_right;
    }
  std::printf(
      "ATE %.1f -> %.2f mm, from the truth %.2f mm; %d observations, %d outliers left out, %d of the others are wrong; "
      "rmse %.3f\n",
      1000 * before_m, 1000 * after_m, 1000 * best_m, report.observations, report.outliers, wrong, report.rmse);
  EXPECT_GT(before_m, 0.03);
  EXPECT_LT(after_m, best_m + 0.002);
  EXPECT_EQ(report.observations, right + wrong);
  EXPECT_GT(report.outliers, 100);
  EXPECT_LT(wrong, 0.005 * right);
  EXPECT_LT(report.rmse, 1);
  EXPECT_EQ(inconsistency(model_), "");
}

// The view keeps only three landmarks, which agree with many of its poses.
TEST_F(MapBundleTest, AViewThatSeesTooLittleGoesWithItsNeighbour) {
  disturb(0.2, 0.01, 0.03);
  const int dark_view = static_cast<int>(model_.views.size()) - 4, view_before = dark_view - 1;
  MapModel::View& dark = model_.views[dark_view];
  int left = 3;
  for (size_t k = 0; k < dark.points.size(); ++k)
    if (dark.points[k] != kNone && left-- <= 0) model_.forget(dark.points[k], dark_view);
  const SE3 dark_from_before = dark.cam_from_map * model_.views[view_before].cam_from_map.inverse();
  const SE3 was = dark.cam_from_map;
  adjust_map({}, {}, &model_);
  const SE3 off =
      model_.views[dark_view].cam_from_map * (dark_from_before * model_.views[view_before].cam_from_map).inverse();
  EXPECT_GT((was.center() - dark.cam_from_map.center()).norm(), 0.001) << "it did not go with it";
  EXPECT_LT(off.log().norm(), 1e-9);
  EXPECT_LT(error().rmse, 0.02);
}

TEST_F(MapBundleWithOutliersTest, InPiecesItFindsTheTruthToo) {
  const MapModel truth = model_;
  adjust_map({}, {}, &model_);
  const double best_m = error().rmse;
  model_ = truth;
  disturb(0.2, 0.01, 0.03);
  const double before_m = error().rmse;
  MapBundleOptions options;
  options.most_views = 12;
  const MapBundleReport report = adjust_map({}, options, &model_);
  const double after_m = error().rmse;
  std::printf("in pieces: ATE %.1f -> %.2f mm, at once from the truth %.2f mm; rmse %.3f, %d outliers\n",
              1000 * before_m, 1000 * after_m, 1000 * best_m, report.rmse, report.outliers);
  EXPECT_GT(before_m, 0.012);
  EXPECT_LT(after_m, best_m + 0.003);
  EXPECT_EQ(report.views, static_cast<int>(model_.views.size()));
  EXPECT_LT(report.rmse, 1);
  EXPECT_GT(report.outliers, 0);
  EXPECT_EQ(inconsistency(model_), "");
  const MapModel adjusted = model_;
  const std::atomic<bool> cancel = true;
  options.cancel = &cancel;
  adjust_map({}, options, &model_);
  for (size_t v = 0; v < model_.views.size(); ++v)
    EXPECT_EQ(model_.views[v].cam_from_map.translation, adjusted.views[v].cam_from_map.translation);
}

TEST_F(MapBundleTest, AWindowLeavesTheRestWhereItIs) {
  disturb(0.2, 0.01, 0.02);
  const MapModel before = model_;
  const std::vector<int> window = {10, 11, 12, 13};
  const MapBundleReport report = adjust_map(window, {}, &model_);
  EXPECT_EQ(report.views, 4);
  EXPECT_GT(report.points, 50);
  std::vector<char> seen(model_.points.size(), 0);
  for (size_t v = 0; v < model_.views.size(); ++v) {
    const bool free = v >= 10 && v <= 13;
    if (free)
      for (int point : before.views[v].points)
        if (point != kNone) seen[point] = 1;
    const SE3 &was = before.views[v].cam_from_map, &is = model_.views[v].cam_from_map;
    EXPECT_EQ(was.translation != is.translation, free) << v;
    EXPECT_EQ(was.rotation.coeffs() != is.rotation.coeffs(), free) << v;
  }
  int moved = 0;
  for (size_t p = 0; p < seen.size(); ++p) {
    moved += model_.points[p].position != before.points[p].position;
    if (!seen[p]) {
      EXPECT_EQ(model_.points[p].position, before.points[p].position);
    }
  }
  EXPECT_GT(moved, 50);
  EXPECT_EQ(inconsistency(model_), "");
}

TEST_F(MapBundleTest, FixedViewsStayAndOneAlwaysIs) {
  disturb(0.2, 0.01, 0.02);
  MapModel fixed = model_;
  fixed.views[7].fixed = true;
  const MapModel before = fixed;
  adjust_map({}, {}, &fixed);
  adjust_map({}, {}, &model_);
  EXPECT_EQ(fixed.views[7].cam_from_map.translation, before.views[7].cam_from_map.translation);
  EXPECT_NE(fixed.views[0].cam_from_map.translation, before.views[0].cam_from_map.translation);
  EXPECT_EQ(model_.views[0].cam_from_map.translation, before.views[0].cam_from_map.translation);
}

TEST_F(MapBundleTest, NothingToAdjust) {
  MapModel empty;
  EXPECT_EQ(adjust_map({}, {}, &empty).views, 0);
  MapModel blind = model_;
  blind.points.clear();
  for (MapModel::View& view : blind.views) view.points.assign(view.points.size(), kNone);
  const SE3 before = blind.views[3].cam_from_map;
  EXPECT_EQ(adjust_map({}, {}, &blind).observations, 0);
  EXPECT_EQ(adjust_map({3}, {}, &blind).observations, 0);
  EXPECT_EQ(blind.views[3].cam_from_map.translation, before.translation);
  MapModel all_fixed = model_;
  for (MapModel::View& view : all_fixed.views) view.fixed = true;
  EXPECT_EQ(adjust_map({}, {}, &all_fixed).views, 0);
  MapModel no_rounds = model_;
  adjust_map({}, {.gates_chi2 = {}}, &no_rounds);
  EXPECT_EQ(no_rounds.points[0].observations.size(), model_.points[0].observations.size());
}

TEST_F(MapBundleTest, NumbersThatAreNoneStayAlone) {
  disturb(0.2, 0.01, 0.02);
  model_.points[11].position.setConstant(NAN);
  model_.points[12].position.setConstant(INFINITY);
  model_.views[5].cam_from_map.translation.setConstant(NAN);
  adjust_map({}, {}, &model_);
  for (size_t v = 0; v < model_.views.size(); ++v)
    if (v != 5) {
      EXPECT_TRUE(model_.views[v].cam_from_map.is_finite()) << v;
    }
  for (size_t p = 0; p < model_.points.size(); ++p)
    if (p != 11 && p != 12) {
      EXPECT_TRUE(model_.points[p].position.allFinite()) << p;
    }
  EXPECT_TRUE(model_.points[11].observations.empty());
}

TEST_F(MapBundleTest, IsRepeatableToTheBit) {
  disturb(0.2, 0.01, 0.02);
  MapModel other = model_;
  adjust_map({}, {}, &model_);
  adjust_map({}, {}, &other);
  for (size_t v = 0; v < model_.views.size(); ++v)
    EXPECT_EQ(model_.views[v].cam_from_map.translation, other.views[v].cam_from_map.translation);
  for (size_t p = 0; p < model_.points.size(); ++p) EXPECT_EQ(model_.points[p].position, other.points[p].position);
}

}  // namespace
}  // namespace rumi::testing
