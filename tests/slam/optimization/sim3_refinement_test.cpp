// SPDX-License-Identifier: BSD-3-Clause
#include "slam/optimization/sim3_refinement.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <limits>
#include <random>

#include "tests/slam/synthetic_scene.h"

namespace rumi {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();

struct Setting {
  int a_into_b = 150, b_into_a = 150;  // landmarks, each seen in two frames
  int frames = 6;                      // frames of each submap
  double spacing = 0.25;               // distance between two frames, unit of A
  double noise_px = 1.0;               // true standard deviation of a pixel; Observation::sigma_px is 1
  double outliers = 0;
  int frame_pairs = 0;
  bool plane = false;
  double points_at = 1;  // factor on the distance of the points
};

struct Overlap {
  Sim3 truth, start;
  Sim3RefinementProblem problem;
};

// Makes an overlap: A has the scene's frame of reference; that of B is turned, scaled and shifted, so that its origin
// lies far away.
Overlap make_overlap(unsigned seed, const Setting& setting = {}) {
  SyntheticScene scene(seed);
  Overlap o;
  o.truth = Sim3(2.5, so3_exp({0.4, -1.0, 0.3}), Eigen::Vector3d(20, -10, 30));
  const auto observe = [&](const Eigen::Vector3d& point, const SE3& cam_from_a) {
    const Eigen::Vector2d seen = test_camera().project_undistorted(cam_from_a * point) + scene.noise(setting.noise_px);
    const bool outlier = scene.uniform(0, 1) < setting.outliers;
    return outlier ? Eigen::Vector2d(scene.uniform(0, 640), scene.uniform(0, 480)) : seen;
  };
  std::vector<SE3> in_a, in_b;  // cam_from_a of the frames of A and of B
  for (int i = 0; i < setting.frames; ++i) {
    in_a.push_back(SyntheticScene::pose(setting.spacing * i, 0, 0.1 * setting.spacing * i, -0.02 * i));
    in_b.push_back(SyntheticScene::pose(setting.spacing * (i + 0.5), 0.1 * setting.spacing, 0, -0.02 * i));
  }
  const int count = setting.a_into_b + setting.b_into_a;
  std::vector<Eigen::Vector3d> points = setting.plane ? scene.plane(count) : scene.cloud(count);
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d p = setting.points_at * points[i];
    for (int k = 0; k < 2; ++k) {
      const int frame = (i + 2 * k) % setting.frames;
      if (i < setting.a_into_b)
        o.problem.a_into_b.push_back({p, o.truth.transform_camera(in_b[frame]), observe(p, in_b[frame]), 1.0});
      else
        o.problem.b_into_a.push_back({o.truth * p, in_a[frame], observe(p, in_a[frame]), 1.0});
    }
  }
  for (int i = 0; i < setting.frame_pairs; ++i) {
    std::normal_distribution<double> n(0, 1);
    const auto random = [&] {
      const double x = n(scene.rng()), y = n(scene.rng()), z = n(scene.rng());
      return Eigen::Vector3d(x, y, z);
    };
    const SE3 in_truth = o.truth.transform_camera(in_a[i % setting.frames]);
    const Eigen::Vector3d center = in_truth.center() + 0.02 * random();
    const Eigen::Quaterniond q = so3_exp(0.01 * random()) * in_truth.rotation;
    o.problem.frame_pairs.push_back({in_a[i % setting.frames], SE3(q, -(q * center)), 0.01, 0.02});
  }
  Vector7d off;
  for (int k = 0; k < 3; ++k) off[k] = scene.uniform(-0.04, 0.04), off[3 + k] = scene.uniform(-0.4, 0.4);
  off[6] = scene.uniform(-0.08, 0.08);
  o.start = o.truth.plus(off, Eigen::Vector3d(0, 0, 4));
  return o;
}

// Returns the squared error in units of the reported covariance. Its mean is 7 if the covariance is right.
double normalized_error(const Sim3RefinementReport& report, const Sim3& found, const Sim3& truth) {
  const Vector7d error = truth.minus(found, report.pivot_a);
  return error.dot(report.covariance.ldlt().solve(error));
}

double mean_normalized_error(const Setting& setting) {
  double sum = 0;
  for (unsigned seed = 0; seed < 50; ++seed) {
    const Overlap o = make_overlap(seed, setting);
    Sim3 found = o.start;
    const Sim3RefinementReport report = refine_sim3(test_camera(), {}, o.problem, &found);
    EXPECT_TRUE(report.usable) << "seed " << seed << ": " << report.reason;
    const double e = normalized_error(report, found, o.truth);
    EXPECT_LT(e, 40) << "seed " << seed;
    sum += e / 50;
  }
  return sum;
}

// 50 draws of a chi2 with 7 degrees of freedom have a mean of 7 +- 0.53.
void expect_calibrated(const Setting& setting) {
  const double mean = mean_normalized_error(setting);
  EXPECT_GT(mean, 5.2);
  EXPECT_LT(mean, 8.8);
}

TEST(RefineSim3, ExactWithoutNoise) {
  Setting setting;
  setting.noise_px = 0;
  const Overlap o = make_overlap(1, setting);
  Sim3 found = o.start;
  const Sim3RefinementReport report = refine_sim3(test_camera(), {}, o.problem, &found);
  ASSERT_TRUE(report.usable) << report.reason;
  EXPECT_LT(o.truth.minus(found).norm(), 1e-6);
  EXPECT_EQ(report.inlier_ratio, 1.0);
  EXPECT_LT(report.rmse_px, 1e-4);
  EXPECT_LT(report.sigma_log_scale, 0.01);
}

TEST(RefineSim3, CovarianceIsCalibrated) { expect_calibrated({}); }

TEST(RefineSim3, CovarianceIsCalibratedWithOutliers) {
  Setting setting;
  setting.outliers = 0.3;
  expect_calibrated(setting);
}

TEST(RefineSim3, CovarianceIsCalibratedInEachDirectionAlone) {
  Setting forth, back;
  forth.b_into_a = back.a_into_b = 0;
  expect_calibrated(forth);
  expect_calibrated(back);
}

TEST(RefineSim3, CovarianceIsCalibratedOnAPlane) {
  Setting setting;
  setting.plane = true;
  setting.outliers = 0.1;
  expect_calibrated(setting);
}

TEST(RefineSim3, CovarianceIsCalibratedWithFramePairs) {
  Setting setting;
  setting.a_into_b = setting.b_into_a = 5;
  setting.frame_pairs = 6;
  // The residual variance of so few equations scatters. That may widen the covariance but never narrows it.
  const auto expect_near = [](double mean) {
    EXPECT_GT(mean, 4.5);
    EXPECT_LT(mean, 8.8);
  };
  expect_near(mean_normalized_error(setting));
  setting.a_into_b = setting.b_into_a = 0;
  setting.frame_pairs = 12;
  expect_near(mean_normalized_error(setting));
}

TEST(RefineSim3, MoreNoiseThanClaimedWidensTheCovariance) {
  Setting setting;
  const Overlap as_claimed = make_overlap(1, setting);
  setting.noise_px = 1.6;
  const Overlap noisier = make_overlap(1, setting);
  Sim3 a = as_claimed.start, b = noisier.start;
  const auto few = refine_sim3(test_camera(), {}, as_claimed.problem, &a);
  const auto more = refine_sim3(test_camera(), {}, noisier.problem, &b);
  EXPECT_GT(more.sigma_log_scale, 1.2 * few.sigma_log_scale);
  EXPECT_NEAR(few.rmse_px, std::sqrt(2 * 0.84), 0.1);
}

TEST(RefineSim3, FindsTheOutliers) {
  Setting setting;
  setting.outliers = 0.3;
  const Overlap o = make_overlap(3, setting);
  Sim3 found = o.start;
  const Sim3RefinementReport report = refine_sim3(test_camera(), {}, o.problem, &found);
  ASSERT_TRUE(report.usable);
  EXPECT_NEAR(report.inlier_ratio, 0.7 * 0.95, 0.05);
  const auto error_px = [&](const Eigen::Vector3d& p, const Sim3RefinementProblem::Observation& seen) {
    return (test_camera().project_undistorted(seen.cam_from_other * p) - seen.pixel).norm();
  };
  for (size_t i = 0; i < o.problem.a_into_b.size(); ++i)
    if (report.a_into_b_inlier[i]) {
      EXPECT_LT(error_px(o.truth * o.problem.a_into_b[i].point, o.problem.a_into_b[i]), 3);
    }
  for (size_t i = 0; i < o.problem.b_into_a.size(); ++i)
    if (report.b_into_a_inlier[i]) {
      EXPECT_LT(error_px(o.truth.inverse() * o.problem.b_into_a[i].point, o.problem.b_into_a[i]), 3);
    }
}

TEST(RefineSim3, AFalseFramePairIsAnOutlier) {
  Setting setting;
  setting.frame_pairs = 4;
  Overlap o = make_overlap(4, setting);
  o.problem.frame_pairs[2].cam_from_b.translation.x() += 3;
  Sim3 found = o.start;
  const Sim3RefinementReport report = refine_sim3(test_camera(), {}, o.problem, &found);
  ASSERT_TRUE(report.usable) << report.reason;
  EXPECT_EQ(report.frame_pair_inlier, (std::vector<bool>{true, true, false, true}));
  EXPECT_LT(normalized_error(report, found, o.truth), 40);
}

TEST(RefineSim3, ASecondDirectionAddsWhatItKnows) {
  Setting both, forth;
  forth.b_into_a = 0;
  const Overlap o = make_overlap(5, both), f = make_overlap(5, forth);
  Sim3 a = o.start, b = f.start;
  const auto of_both = refine_sim3(test_camera(), {}, o.problem, &a);
  const auto of_one = refine_sim3(test_camera(), {}, f.problem, &b);
  EXPECT_LT(of_both.sigma_log_scale, 0.85 * of_one.sigma_log_scale);
  EXPECT_LT(of_both.sigma_rotation_rad, of_one.sigma_rotation_rad);
}

TEST(RefineSim3, ThePivotIsWhereTheTranslationIsKnownBest) {
  const Overlap o = make_overlap(6);
  Sim3 found = o.start;
  const Sim3RefinementReport report = refine_sim3(test_camera(), {}, o.problem, &found);
  ASSERT_TRUE(report.usable);
  const auto trace_at = [&](const Eigen::Vector3d& v) {
    Eigen::Matrix<double, 3, 7> by_step;
    by_step << -skew(v), Eigen::Matrix3d::Identity(), v;
    return (by_step * report.covariance * by_step.transpose()).trace();
  };
  for (int k = 0; k < 3; ++k)
    for (double d : {-0.5, 0.5}) EXPECT_GT(trace_at(d * Eigen::Vector3d::Unit(k)), trace_at({0, 0, 0}));
}

TEST(RefineSim3, UnitsDoNotMatter) {
  // `small` is the overlap of `o`, with B in a unit that is a million times smaller.
  const Overlap o = make_overlap(7);
  Overlap small = o;
  const double unit = 1e6;
  const auto shrink = [unit](Sim3 t) { return Sim3(t.scale * unit, t.rotation, t.translation * unit); };
  for (auto& seen : small.problem.a_into_b) seen.cam_from_other.translation *= unit;
  for (auto& seen : small.problem.b_into_a) seen.point *= unit;
  Sim3 found = o.start, found_small = shrink(o.start);
  const auto report = refine_sim3(test_camera(), {}, o.problem, &found);
  const auto report_small = refine_sim3(test_camera(), {}, small.problem, &found_small);
  ASSERT_TRUE(report.usable && report_small.usable);
  EXPECT_NEAR(found_small.scale / unit, found.scale, 1e-5);
  EXPECT_NEAR(report_small.sigma_log_scale, report.sigma_log_scale, 1e-3 * report.sigma_log_scale);
  EXPECT_NEAR(report_small.sigma_translation / unit, report.sigma_translation, 1e-3 * report.sigma_translation);
}

TEST(RefineSim3, TinyBaselinesLeaveTheScaleUnsure) {
  Setting setting;
  double last = 0;
  for (double spacing : {0.25, 0.05, 0.01}) {
    setting.spacing = spacing;
    const Overlap o = make_overlap(8, setting);
    Sim3 found = o.start;
    const Sim3RefinementReport report = refine_sim3(test_camera(), {}, o.problem, &found);
    ASSERT_TRUE(report.usable) << spacing << ": " << report.reason;
    EXPECT_LT(normalized_error(report, found, o.truth), 40);
    EXPECT_GT(report.sigma_log_scale, 3 * last);

    last = report.sigma_log_scale;
  }
}

TEST(RefineSim3, OneCameraPositionDoesNotFixTheScale) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    Setting setting;
    setting.spacing = 0;
    if (seed % 2) setting.b_into_a = 0;
    const Overlap o = make_overlap(seed, setting);
    Sim3 found = o.start;
    const Sim3RefinementReport report = refine_sim3(test_camera(), {}, o.problem, &found);
    EXPECT_FALSE(report.usable);
    EXPECT_NE(report.reason.find("scale"), std::string::npos) << report.reason;
    EXPECT_EQ(report.sigma_log_scale, kInfinity);
    EXPECT_TRUE(report.covariance.allFinite());
    EXPECT_EQ(found.translation, o.start.translation);
  }
}

TEST(RefineSim3, AMeasuredScaleDecidesWhereReprojectionCannot) {
  double mean = 0;
  for (unsigned seed = 0; seed < 50; ++seed) {
    Setting setting;
    setting.spacing = 0;
    Overlap o = make_overlap(seed, setting);
    std::mt19937 rng(seed);
    constexpr double kSigma = 0.02;
    const double measured = std::log(o.truth.scale) + std::normal_distribution<double>(0, kSigma)(rng);
    o.problem.scales = {{measured, kSigma}};
    Sim3 found = o.start;
    const Sim3RefinementReport report = refine_sim3(test_camera(), {}, o.problem, &found);
    ASSERT_TRUE(report.usable) << report.reason;
    EXPECT_NEAR(std::log(found.scale), measured, 0.2 * kSigma);
    EXPECT_NEAR(report.sigma_log_scale, kSigma, 0.2 * kSigma);
    mean += normalized_error(report, found, o.truth) / 50;
  }
  EXPECT_GT(mean, 5.2);
  EXPECT_LT(mean, 8.8);
}

TEST(RefineSim3, AVagueScaleChangesNothing) {
  Overlap o = make_overlap(5);
  Sim3 without = o.start, with = o.start;
  refine_sim3(test_camera(), {}, o.problem, &without);
  o.problem.scales = {{std::log(o.truth.scale) + 0.5, 100}};
  refine_sim3(test_camera(), {}, o.problem, &with);
  EXPECT_NEAR(with.scale / without.scale, 1, 1e-6);
}

TEST(RefineSim3, PointsAtInfinityFixTheRotationOnly) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    Setting setting;
    setting.points_at = 1e7;
    const Overlap o = make_overlap(seed, setting);
    Sim3 found = o.start;
    const Sim3RefinementReport report = refine_sim3(test_camera(), {}, o.problem, &found);
    EXPECT_FALSE(report.usable);
    EXPECT_EQ(report.sigma_log_scale, kInfinity);
    EXPECT_TRUE(report.covariance.allFinite());
  }
}

TEST(RefineSim3, PointsAtOnePlaceFixNeitherRotationNorScale) {
  Overlap o = make_overlap(11);
  const Eigen::Vector3d point(0.3, -0.2, 4);
  for (auto& seen : o.problem.a_into_b) {
    seen.point = point;
    seen.pixel = test_camera().project_undistorted(seen.cam_from_other * (o.truth * point));
  }
  o.problem.b_into_a.clear();
  Sim3 found = o.start;
  const Sim3RefinementReport report = refine_sim3(test_camera(), {}, o.problem, &found);
  EXPECT_FALSE(report.usable);
  EXPECT_NE(report.reason.find("not determined"), std::string::npos) << report.reason;
  EXPECT_EQ(report.sigma_rotation_rad, kInfinity);
  EXPECT_EQ(report.sigma_log_scale, kInfinity);
  EXPECT_TRUE(report.covariance.allFinite());
}

TEST(RefineSim3, PointsBehindTheCameraAreOutliers) {
  Overlap o = make_overlap(12);
  for (int i = 0; i < 60; ++i) {
    const SE3 a_from_cam = o.problem.b_into_a[i].cam_from_other.inverse();
    o.problem.b_into_a[i].point = o.truth * (a_from_cam * Eigen::Vector3d(0.1, 0.2, i < 30 ? -3 : 0));
  }
  Sim3 found = o.start;
  const Sim3RefinementReport report = refine_sim3(test_camera(), {}, o.problem, &found);
  ASSERT_TRUE(report.usable) << report.reason;
  for (int i = 0; i < 60; ++i) EXPECT_FALSE(report.b_into_a_inlier[i]);
  EXPECT_LT(normalized_error(report, found, o.truth), 40);
  // If all points are behind the cameras, nothing is left, but nothing breaks.
  for (auto& seen : o.problem.a_into_b) seen.point = -seen.point;
  o.problem.b_into_a.clear();
  const Sim3RefinementReport none = refine_sim3(test_camera(), {}, o.problem, &found);
  EXPECT_FALSE(none.usable);
  EXPECT_EQ(none.inliers, 0);
  EXPECT_EQ(none.rmse_px, 0);
}

TEST(RefineSim3, RefusesNonsenseWithAReason) {
  const Overlap good = make_overlap(13);
  const auto reason = [&](auto spoil) {
    Overlap o = good;
    spoil(&o);
    Sim3 found = o.start;
    const Sim3RefinementReport report = refine_sim3(test_camera(), {}, o.problem, &found);
    EXPECT_FALSE(report.usable);
    EXPECT_EQ(found.rotation.coeffs(), o.start.rotation.coeffs());
    return report.reason;
  };
  EXPECT_EQ(reason([](Overlap* o) { o->problem.a_into_b[3].pixel.x() = kNaN; }), "a_into_b[3] is not finite");
  EXPECT_EQ(reason([](Overlap* o) { o->problem.b_into_a[4].point.z() = kNaN; }), "b_into_a[4] is not finite");
  EXPECT_EQ(reason([](Overlap* o) { o->problem.b_into_a[0].cam_from_other.translation.x() = kNaN; }),
            "b_into_a[0] is not finite");
  EXPECT_EQ(reason([](Overlap* o) { o->problem.a_into_b[0].sigma_px = 0; }), "a_into_b[0]: sigma_px <= 0");
  EXPECT_EQ(reason([](Overlap* o) {
              o->problem.frame_pairs.push_back({SE3(), SE3(), -1, 1});
            }),
            "frame_pairs[0]: sigma <= 0");
  EXPECT_EQ(reason([](Overlap* o) { o->problem.scales = {{0, 1}, {0, 0}}; }), "scales[1] is no measurement");
  EXPECT_EQ(reason([](Overlap* o) { o->start.scale = 0; }), "the initial similarity is not finite");
  EXPECT_NE(reason([](Overlap* o) { o->problem = {}; }).find("too few"), std::string::npos);
  EXPECT_NE(reason([](Overlap* o) { o->problem.a_into_b.resize(3), o->problem.b_into_a.resize(3); }).find("too few"),
            std::string::npos);
}

TEST(RefineSim3, RunsAreIdentical) {
  Setting setting;
  setting.outliers = 0.3;
  const Overlap o = make_overlap(14, setting);
  Sim3 a = o.start, b = o.start;
  const auto first = refine_sim3(test_camera(), {}, o.problem, &a);
  const auto second = refine_sim3(test_camera(), {}, o.problem, &b);
  EXPECT_EQ(a.translation, b.translation);
  EXPECT_EQ(first.covariance, second.covariance);
}

}  // namespace
}  // namespace rumi
