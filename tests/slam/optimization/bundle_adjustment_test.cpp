// SPDX-License-Identifier: BSD-3-Clause
#include "slam/optimization/bundle_adjustment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <tuple>

#include "tests/slam/optimization/ceres_bundle.h"
#include "tests/slam/synthetic_scene.h"

namespace rumi {
namespace {

struct Scene {
  BundleProblem truth, start;
};

Scene make_scene(unsigned seed, double noise_px, double outliers) {
  SyntheticScene scene(seed);
  Scene s;
  s.truth.points = scene.cloud(150);
  for (int i = 0; i < 6; ++i) s.truth.views.push_back({SyntheticScene::pose(0.15 * i, 0.02 * i, 0, -0.02 * i), i < 2});
  for (int v = 0; v < 6; ++v)
    for (int p = 0; p < 150; ++p) {
      Eigen::Vector2d pixel = test_camera().project_undistorted(s.truth.views[v].cam_from_submap * s.truth.points[p]) +
                              scene.noise(noise_px);
      if (scene.uniform(0, 1) < outliers) pixel += Eigen::Vector2d(scene.uniform(20, 60), scene.uniform(-60, 60));
      s.truth.observations.push_back({v, p, pixel, 1.0});
    }
  s.start = s.truth;
  for (auto& p : s.start.points) p *= 1 + scene.uniform(-0.05, 0.05);
  for (int v = 2; v < 6; ++v) {
    Vector6d twist;
    for (int i = 0; i < 6; ++i) twist[i] = scene.uniform(-0.02, 0.02);
    s.start.views[v].cam_from_submap = SE3::exp(twist) * s.start.views[v].cam_from_submap;
  }
  return s;
}

TEST(Bundle, RecoversStructureAndMotion) {
  const Scene s = make_scene(1, 0.5, 0);
  BundleProblem problem = s.start;
  const BundleReport report = solve_bundle(test_camera(), {30, 5.991}, &problem);
  ASSERT_TRUE(report.usable);
  EXPECT_LT(report.final_cost, 0.1 * report.initial_cost);
  for (size_t v = 0; v < problem.views.size(); ++v) {
    EXPECT_LT(rotation_error_deg(problem.views[v].cam_from_submap, s.truth.views[v].cam_from_submap), 0.15);
    EXPECT_LT((problem.views[v].cam_from_submap.center() - s.truth.views[v].cam_from_submap.center()).norm(), 0.01);
  }
  double error = 0;
  for (size_t p = 0; p < problem.points.size(); ++p) error += (problem.points[p] - s.truth.points[p]).norm() / 150;
  EXPECT_LT(error, 0.06);
}

TEST(Bundle, OutliersBendItOnlyALittle) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    const Scene s = make_scene(seed, 0.5, 0.03);
    BundleProblem problem = s.start;
    ASSERT_TRUE(solve_bundle(test_camera(), {30, 5.991}, &problem).usable);
    for (size_t v = 0; v < problem.views.size(); ++v) {
      EXPECT_LT(rotation_error_deg(problem.views[v].cam_from_submap, s.truth.views[v].cam_from_submap), 0.25);
      EXPECT_LT((problem.views[v].cam_from_submap.center() - s.truth.views[v].cam_from_submap.center()).norm(), 0.025);
    }
  }
}

TEST(Bundle, FixedViewsStayAndRunsAreIdentical) {
  const Scene s = make_scene(2, 0.5, 0);
  BundleProblem a = s.start, b = s.start;
  solve_bundle(test_camera(), {10, 5.991}, &a);
  solve_bundle(test_camera(), {10, 5.991}, &b);
  for (int v = 0; v < 2; ++v)
    EXPECT_EQ(a.views[v].cam_from_submap.translation, s.start.views[v].cam_from_submap.translation);
  for (size_t v = 0; v < a.views.size(); ++v)
    EXPECT_EQ(a.views[v].cam_from_submap.translation, b.views[v].cam_from_submap.translation);
  for (size_t p = 0; p < a.points.size(); ++p) EXPECT_EQ(a.points[p], b.points[p]);
}

// Returns a walk in which each point is seen by up to `reach` views before and after it. All views and points are at
// their true places; the first two views are fixed.
BundleProblem walk(int views, int reach, SyntheticScene* scene) {
  BundleProblem truth;
  for (int v = 0; v < views; ++v) truth.views.push_back({SyntheticScene::pose(0.004 * v, 0, 0, 0), v < 2});
  truth.points = scene->cloud(views);
  for (int p = 0; p < views; ++p) {
    for (int v = std::max(0, p - reach); v < std::min(views, p + reach); ++v) {
      const Eigen::Vector3d in_camera = truth.views[v].cam_from_submap * truth.points[p];
      truth.observations.push_back({v, p, test_camera().project_undistorted(in_camera), 1.0});
    }
  }
  return truth;
}

double worst_position_error(const BundleProblem& problem, const BundleProblem& truth) {
  double worst = 0;
  for (size_t v = 0; v < truth.views.size(); ++v)
    worst =
        std::max(worst, (problem.views[v].cam_from_submap.center() - truth.views[v].cam_from_submap.center()).norm());
  return worst;
}

// Tests a room in which every view sees everything, and a walk in which only neighbouring views see the same points.
TEST(Bundle, RecoversHundredsOfViewsWhateverTheySee) {
  constexpr int kViews = 220;
  for (const int reach : {kViews, 6}) {
    SyntheticScene scene(5);
    const BundleProblem truth = walk(kViews, reach, &scene);
    BundleProblem problem = truth;
    for (auto& point : problem.points) point *= 1 + scene.uniform(-0.05, 0.05);
    ASSERT_TRUE(solve_bundle(test_camera(), {20, 5.991, 1e-8}, &problem).usable);
    EXPECT_LT(worst_position_error(problem, truth), 1e-3) << "seen by " << 2 * reach << " views";
  }
}

// The solver uses earlier problems for later ones. That must not mislead it, be it a problem with other views, one with
// as many views that see other points, or one with other noise.
TEST(Bundle, OneSolverSolvesManyProblems) {
  BundleSolver solver;
  SyntheticScene scene(7);
  for (const auto& [views, reach, noise_px] : std::vector<std::tuple<int, int, double>>{
           {80, 6, 0.5}, {80, 80, 0.5}, {80, 6, 1.0}, {30, 6, 0.5}, {130, 5, 0.5}, {130, 5, 0.2}}) {
    BundleProblem problem = walk(views, reach, &scene);
    for (auto& point : problem.points) point *= 1 + scene.uniform(-0.02, 0.02);
    for (auto& o : problem.observations) o.pixel += scene.noise(noise_px);
    BundleProblem alone = problem;
    const BundleReport report = solver.solve(test_camera(), {60, 5.991, 1e-9}, &problem);
    ASSERT_TRUE(report.usable);
    EXPECT_NEAR(report.final_cost, solve_by_ceres(test_camera(), {60, 5.991, 1e-9}, &alone).final_cost,
                1e-4 * report.final_cost)
        << views << " views, " << reach;
  }
}

TEST(Bundle, WhatIsNotUsedBendsNothing) {
  const Scene s = make_scene(3, 0.5, 0.2);
  BundleProblem all = s.start, chosen = s.start;
  chosen.observations.clear();
  std::vector<char> used;
  for (const BundleProblem::Observation& o : all.observations) {
    used.push_back(reprojection_chi2(test_camera(), s.truth, o) < 9);
    if (used.back()) chosen.observations.push_back(o);
  }
  BundleSolver().solve(test_camera(), {30, 5.991}, &all, used);
  solve_bundle(test_camera(), {30, 5.991}, &chosen);
  EXPECT_EQ(all.observations.size(), s.start.observations.size());
  for (size_t p = 0; p < all.points.size(); ++p) EXPECT_EQ(all.points[p], chosen.points[p]);
  for (size_t v = 0; v < all.views.size(); ++v)
    EXPECT_EQ(all.views[v].cam_from_submap.translation, chosen.views[v].cam_from_submap.translation);
}

// Compares two implementations on input that is hard for both: outliers, edges, points seen once, never, twice by the
// same view or only by fixed views, and a view that sees nothing.
TEST(Bundle, AgreesWithCeres) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    const bool has_edges = seed % 2 == 1;
    BundleProblem problem = make_scene(seed, 0.5, has_edges ? 0 : 0.03).start;
    problem.views.push_back({SyntheticScene::pose(1, 2, 3), false});
    problem.points.emplace_back(0, 0, 3);
    const Eigen::Vector2d center(test_camera().cx, test_camera().cy);
    for (const auto& [point, views] : std::vector<std::pair<Eigen::Vector3d, std::vector<int>>>{
             {{0, 0, 3}, {3}}, {{0, 0, 4}, {4, 4, 5}}, {{0, 0, 5}, {0, 1}}}) {
      for (int view : views)
        problem.observations.push_back({view, static_cast<int>(problem.points.size()), center, 2.0});
      problem.points.push_back(point);
    }
    SyntheticScene edges(seed);
    for (auto& o : problem.observations)
      if (has_edges) o.whitening = edge_noise(edges, 1, edges.uniform(0, M_PI), 4).whitening;
    BundleProblem reference = problem;
    const BundleReport ours = solve_bundle(test_camera(), {50, 5.991, 1e-12}, &problem);
    const BundleReport by_ceres = solve_by_ceres(test_camera(), {50, 5.991, 1e-12}, &reference);
    ASSERT_TRUE(ours.usable && by_ceres.usable);
    EXPECT_NEAR(ours.initial_cost, by_ceres.initial_cost, 1e-9 * by_ceres.initial_cost);
    EXPECT_NEAR(ours.final_cost, by_ceres.final_cost, 1e-6 * by_ceres.final_cost);
    for (size_t v = 0; v < problem.views.size(); ++v)
      EXPECT_LT((problem.views[v].cam_from_submap.center() - reference.views[v].cam_from_submap.center()).norm(), 1e-4);
    // Points are compared in pixels, because one that lies on an edge in all views may be at any depth.
    for (const int v : {0, 5})
      for (size_t p = 0; p < 150; ++p) {
        const auto pixel = [&](const BundleProblem& of) {
          return test_camera().project_undistorted(of.views[v].cam_from_submap * of.points[p]);
        };
        EXPECT_LT((pixel(problem) - pixel(reference)).norm(), 0.1);
      }
  }
}

// Most keypoints lie on edges and slide along them. If their whitening says so, the last camera's position is much more
// accurate.
TEST(Bundle, WhatSlidesAlongEdgesBendsNothing) {
  double told = 0, untold = 0;
  for (unsigned seed = 0; seed < 10; ++seed) {
    BundleProblem problem = make_scene(seed, 0.3, 0).start;
    const std::vector<BundleProblem::View> truth = make_scene(seed, 0.3, 0).truth.views;
    SyntheticScene edges(seed);
    for (auto& o : problem.observations) {
      if (o.point % 5 == 0) continue;
      const EdgeNoise edge = edge_noise(edges, 0.3, edges.uniform(-0.2, 0.2), 6);
      o.pixel += edge.error;
      o.whitening = edge.whitening;
    }
    BundleProblem blind = problem;
    for (auto& o : blind.observations) o.whitening.setIdentity();
    ASSERT_TRUE(solve_bundle(test_camera(), {30, 5.991}, &problem).usable);
    ASSERT_TRUE(solve_bundle(test_camera(), {30, 5.991}, &blind).usable);
    const auto off = [&](const BundleProblem& p) {
      return (p.views.back().cam_from_submap.center() - truth.back().cam_from_submap.center()).norm() / 10;
    };
    told += off(problem);
    untold += off(blind);
  }
  EXPECT_LT(told, 0.008);
  EXPECT_LT(told, 0.6 * untold);
}

// A step that goes too far is undone, so that the cost never rises.
TEST(Bundle, NoStepMakesItWorse) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    BundleProblem problem = make_scene(seed, 0.5, 0.1).start;
    SyntheticScene scene(seed + 100);
    for (auto& point : problem.points) point *= 1 + scene.uniform(-0.6, 2);
    double last = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 10; ++i) {
      const BundleReport report = solve_bundle(test_camera(), {1, 5.991, 0}, &problem);
      ASSERT_TRUE(report.usable);
      EXPECT_LE(report.final_cost, report.initial_cost);
      EXPECT_LE(report.initial_cost, last * (1 + 1e-12));
      last = report.final_cost;
    }
  }
}

TEST(Bundle, EndsWhenItIsToldTo) {
  const std::atomic<bool> cancel = true;
  BundleProblem problem = make_scene(1, 0.5, 0).start;
  const BundleReport report = solve_bundle(test_camera(), {30, 5.991, 1e-4, &cancel}, &problem);
  EXPECT_EQ(report.final_cost, report.initial_cost);
}

TEST(Bundle, NothingToSolveIsNoError) {
  BundleProblem empty;
  EXPECT_FALSE(solve_bundle(test_camera(), {}, &empty).usable);
  Scene s = make_scene(3, 0.5, 0);
  for (auto& v : s.start.views) v.fixed = true;
  EXPECT_FALSE(solve_bundle(test_camera(), {}, &s.start).usable);
}

TEST(Bundle, PointBehindTheCameraOrNowhereLeavesTheProblemUnchanged) {
  Scene s = make_scene(4, 0.5, 0);
  s.start.points[7].z() = -3;
  const BundleProblem before = s.start;
  EXPECT_FALSE(solve_bundle(test_camera(), {}, &s.start).usable);
  EXPECT_EQ(s.start.points[8], before.points[8]);
  s.start = before;
  s.start.points[7].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(solve_bundle(test_camera(), {}, &s.start).usable);
  EXPECT_EQ(s.start.points[8], before.points[8]);
  EXPECT_EQ(reprojection_chi2(test_camera(), before, before.observations[7]), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace rumi
