// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/frame/certainty.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "slam/geometry/triangulation.h"
#include "slam/optimization/bundle_adjustment.h"
#include "tests/front_tracker/feature_scene.h"

namespace rumi::front_tracker {
namespace {

constexpr int kTrials = 200;
constexpr double kNoise_px = 1.0;

// Expects the standard deviation over the trials to be within a fifth of the predicted one.
void expect_honest(double sum_of_squares, double told_variance, const char* what) {
  const double ratio = std::sqrt(sum_of_squares / kTrials / told_variance);
  EXPECT_GT(ratio, 0.8) << what;
  EXPECT_LT(ratio, 1.2) << what;
}

// Landmarks whose positions are known well across the rays of a camera at the origin and poorly along them, and a frame
// that sees them.
struct SeenLandmarks {
  Submap submap;
  Frame frame;
};

SeenLandmarks see(const std::vector<Eigen::Vector3d>& points, const SE3& cam_from_submap) {
  SeenLandmarks seen;
  seen.submap.camera = test_camera();
  Features features;
  for (const Eigen::Vector3d& p : points) {
    const int id = static_cast<int>(features.size());
    Landmark& lm = seen.submap.landmarks[id];
    lm.position = p;
    lm.information = sight_information(p, 1e-3) + p * p.transpose() / std::pow(0.03 * p.squaredNorm(), 2);
    features.keypoints.push_back({test_camera().project_undistorted(cam_from_submap * p).cast<float>(), 0, 0});
    features.descriptors.push_back({});
  }
  seen.frame = make_frame(1, std::move(features), test_camera());
  seen.frame.cam_from_submap = cam_from_submap;
  for (size_t k = 0; k < points.size(); ++k) seen.frame.landmark_ids[k] = static_cast<int>(k);
  return seen;
}

// A sigma is for one coordinate, so its square is a third of the covariance's trace. The covariance of the reference
// keyframe is added.
TEST(Certainty, WhatIsToldAddsWhatWasKnownOfTheKeyframe) {
  FrontSubmap submap;
  submap.map.keyframes[3].id = 3;
  Frame frame;
  EXPECT_EQ(sigmas_of(submap, frame), PoseSigmas()) << "nothing is known";
  frame.certainty.twist_covariance.diagonal() << 1, 2, 6, 0.04, 0.05, 0.09;
  frame.certainty.log_scale_variance = 0.25;
  const auto expect = [&](double position, double rotation) {
    const PoseSigmas told = sigmas_of(submap, frame);
    EXPECT_FLOAT_EQ(told.position, static_cast<float>(position));
    EXPECT_FLOAT_EQ(told.rotation_rad, static_cast<float>(rotation));
    EXPECT_FLOAT_EQ(told.log_scale, 0.5F);
  };
  expect(std::sqrt(3), std::sqrt(0.06));
  frame.reference_keyframe = 3;
  expect(std::sqrt(3), std::sqrt(0.06));  // one of the first keyframes: it defines the submap's coordinate system
  PoseCertainty of_keyframe;
  of_keyframe.twist_covariance.diagonal() << 3, 3, 3, 0.03, 0.03, 0.03;
  note_certainty(3, of_keyframe, &submap);
  expect(std::sqrt(6), 0.3);
  frame.certainty = certainty_of(submap.map, {1}, make_frame(1, {}, test_camera()));
  EXPECT_EQ(sigmas_of(submap, frame), PoseSigmas()) << "it sees nothing";
  frame.certainty.twist_covariance(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(sigmas_of(submap, frame), PoseSigmas());
}

TEST(Certainty, APoseIsOffByAsMuchAsItsCovarianceSays) {
  const Camera camera = test_camera();
  SyntheticScene scene(3);
  const SE3 truth = SyntheticScene::pose(0.3, -0.1, 0.2, 0.05);
  const SeenLandmarks known = see(scene.cloud(80), truth);
  const Matrix6d covariance = certainty_of(known.submap, {kNoise_px}, known.frame).twist_covariance;
  double position2 = 0, rotation2 = 0;
  std::normal_distribution<double> normal(0, 1);
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<PointObservation> seen;
    for (const auto& [id, lm] : known.submap.landmarks) {
      const Eigen::Matrix3d root = Eigen::Matrix3d(lm.information.inverse()).llt().matrixL();
      const Eigen::Vector3d off(normal(scene.rng()), normal(scene.rng()), normal(scene.rng()));
      const Eigen::Vector2d pixel = camera.project_undistorted(truth * lm.position) + scene.noise(kNoise_px);
      // The whitening includes the landmark's uncertainty, as the covariance supposes.
      const Eigen::Vector3d p = truth * lm.position;
      Eigen::Matrix<double, 2, 3> d;
      d << camera.fx / p.z(), 0, -camera.fx * p.x() / (p.z() * p.z()), 0, camera.fy / p.z(),
          -camera.fy * p.y() / (p.z() * p.z());
      d = d * truth.rotation.toRotationMatrix();
      const Eigen::Matrix2d noise = Eigen::Matrix2d::Identity() + d * lm.information.inverse() * d.transpose();
      const Eigen::Matrix2d whitening = Eigen::Matrix2d(noise.llt().matrixL()).inverse();
      seen.push_back({lm.position + root * off, pixel, 1.0, whitening});
    }
    PoseOptimizerOptions options;
    options.inlier_chi2 = 100;
    const SE3 found = optimize_pose(camera, truth, seen, options).cam_from_submap;
    const Vector6d twist = (found * truth.inverse()).log();
    position2 += twist.head<3>().squaredNorm();
    rotation2 += twist.tail<3>().squaredNorm();
  }
  expect_honest(position2, covariance.topLeftCorner<3, 3>().trace(), "position");
  expect_honest(rotation2, covariance.bottomRightCorner<3, 3>().trace(), "rotation");
}

// Adjusts two views, a third one between them, and their points. The direction to the second view must be as uncertain
// as predicted.
TEST(Certainty, TheDirectionOfAMotionIsOffByAsMuchAsItsCovarianceSays) {
  const Camera camera = test_camera();
  SyntheticScene scene(5);
  const std::vector<Eigen::Vector3d> points = scene.cloud(150);
  const std::vector<SE3> views = {SE3(), SyntheticScene::pose(0.3, 0.05, 0.1), SyntheticScene::pose(0.15, 0.02, 0.05)};
  FreeStructure structure{views, {}};
  for (const Eigen::Vector3d& p : points)
    structure.points.push_back({p, {{0, kNoise_px}, {1, kNoise_px}, {2, kNoise_px}}});
  const Eigen::Matrix3d told = position_covariance(views[1], second_twist_covariance(camera, structure));
  double off2 = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    BundleProblem problem;
    for (const SE3& view : views) problem.views.push_back({view, problem.views.empty()});
    problem.points = points;
    for (int v = 0; v < 3; ++v)
      for (int p = 0; p < static_cast<int>(points.size()); ++p)
        problem.observations.push_back(
            {v, p, camera.project_undistorted(views[v] * points[p]) + scene.noise(kNoise_px), kNoise_px});
    ASSERT_TRUE(
        solve_bundle(camera, {.iterations = 20, .huber_chi2 = 100, .function_tolerance = 1e-9}, &problem).usable);
    const Eigen::Vector3d direction = problem.views[1].cam_from_submap.center().normalized();
    off2 += (direction - views[1].center().normalized()).squaredNorm();
  }
  expect_honest(off2, told.trace() / views[1].center().squaredNorm(), "direction");
}

TEST(Certainty, FewLandmarksInACornerLeaveTheImageUncertain) {
  FeatureScene scene(1);
  const auto submap = scene.submap({SE3(), SyntheticScene::pose(0.3, 0, 0), SyntheticScene::pose(0.6, 0, 0)});
  Frame frame = scene.frame(1'000'000, SyntheticScene::pose(0.4, 0, 0));
  frame.cam_from_submap = SyntheticScene::pose(0.4, 0, 0);
  for (const auto& [id, lm] : submap->map.landmarks) {
    const Eigen::Vector2f at = test_camera().project_undistorted(frame.cam_from_submap * lm.position).cast<float>();
    for (size_t k = 0; k < frame.features->size(); ++k)
      if ((frame.features->undistorted[k] - at).norm() < 3) frame.landmark_ids[k] = id;
  }
  const double all_px = certainty_of(submap->map, submap->octave_scales, frame).image_px;
  EXPECT_LT(all_px, 0.5);
  for (size_t k = 0; k < frame.landmark_ids.size(); ++k)
    if (frame.features->undistorted[k].x() > 200 || frame.features->undistorted[k].y() > 200)
      frame.landmark_ids[k] = kNone;
  ASSERT_GE(frame.matches(), 10);
  EXPECT_GT(certainty_of(submap->map, submap->octave_scales, frame).image_px, 5 * all_px);
}

// Scale errors add up from landmark to landmark; observing an old landmark again would bring the scale back.
TEST(Certainty, TheScaleIsCarriedByLandmarks) {
  FeatureScene scene(2);
  const auto submap = scene.submap({SE3(), SyntheticScene::pose(0.3, 0, 0), SyntheticScene::pose(0.301, 0, 0)});
  PoseCertainty certainty;
  certainty.twist_covariance = 1e-4 * Matrix6d::Identity();
  certainty.log_scale_variance = 0.01;
  note_certainty(1, certainty, submap.get());
  note_certainty(2, certainty, submap.get());
  EXPECT_NEAR(log_baseline_variance(*submap, 1, 0), 1e-4 / 0.09, 1e-6) << "the first keyframe is exact";
  EXPECT_NEAR(log_scale_variance_between(*submap, 1, 0), 0.01 + 1e-4 / 0.09, 1e-6);
  EXPECT_GT(log_baseline_variance(*submap, 2, 1), 1) << "on the spot nothing is known of the distance";
  for (const auto& [id, lm] : submap->map.landmarks) EXPECT_EQ(lm.log_scale_variance, 0) << "it is not made worse";
  EXPECT_TRUE(std::isinf(log_length_variance(Eigen::Vector3d::Zero(), Eigen::Matrix3d::Identity())));
}

}  // namespace
}  // namespace rumi::front_tracker
