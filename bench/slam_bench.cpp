// SPDX-License-Identifier: BSD-3-Clause
// The pieces that cost: keypoints (beside OpenCV's own ORB on the same image), matching, pose, bundle adjustment.
#include <benchmark/benchmark.h>

#include <opencv2/core/utility.hpp>
#include <opencv2/features2d.hpp>

#include "bench/rendered_images.h"
#include "slam/features/matching.h"
#include "slam/features/orb_extractor.h"
#include "slam/optimization/bundle_adjustment.h"
#include "slam/optimization/pose_optimizer.h"
#include "tests/slam/synthetic_scene.h"

namespace rumi {
namespace {

void BM_OpenCvOrb1000(benchmark::State& state) {
  cv::setNumThreads(1);
  const auto orb = cv::ORB::create(1000);
  const cv::Mat& grey = rendered_images().grey[0];
  for (auto _ : state) {
    std::vector<cv::KeyPoint> keypoints;
    cv::Mat descriptors;
    orb->detectAndCompute(grey, cv::noArray(), keypoints, descriptors);
  }
}
BENCHMARK(BM_OpenCvOrb1000)->Unit(benchmark::kMillisecond);

void BM_OrbExtractor(benchmark::State& state) {
  cv::setNumThreads(1);
  const OrbExtractor extractor({});
  const cv::Mat& grey = rendered_images().grey[0];
  for (auto _ : state) benchmark::DoNotOptimize(extractor.extract(grey, static_cast<int>(state.range(0))));
}
BENCHMARK(BM_OrbExtractor)->Arg(1000)->Arg(2000)->Unit(benchmark::kMillisecond);

void BM_MatchAllWithAll(benchmark::State& state) {
  const OrbExtractor extractor({});
  Features a = extractor.extract(rendered_images().grey[0]), b = extractor.extract(rendered_images().grey[10]);
  a.undistort(rendered_images().camera);
  b.undistort(rendered_images().camera);
  for (auto _ : state) benchmark::DoNotOptimize(match_features(a, {}, b, {}, {}));
}
BENCHMARK(BM_MatchAllWithAll)->Unit(benchmark::kMillisecond);

void BM_OptimizePose(benchmark::State& state) {
  SyntheticScene scene(1);
  std::vector<PointObservation> observations;
  const SE3 truth = SyntheticScene::pose(0.2, -0.1, 0.1, 0.05);
  for (const Eigen::Vector3d& p : scene.cloud(static_cast<int>(state.range(0))))
    observations.push_back({p, test_camera().project_undistorted(truth * p) + scene.noise(0.7), 1.0});
  for (auto _ : state)
    benchmark::DoNotOptimize(optimize_pose(test_camera(), SyntheticScene::pose(0.15, -0.1, 0.1), observations));
}
BENCHMARK(BM_OptimizePose)->Arg(100)->Arg(300)->Unit(benchmark::kMicrosecond);

void BM_LocalBundle(benchmark::State& state) {
  SyntheticScene scene(2);
  BundleProblem start;
  start.points = scene.cloud(1000);
  const int views = static_cast<int>(state.range(0));
  for (int v = 0; v < views; ++v) start.views.push_back({SyntheticScene::pose(0.1 * v, 0, 0.02 * v), v < 2});
  for (int v = 0; v < views; ++v)
    for (int p = 0; p < 1000; ++p)
      if (scene.uniform(0, 1) < 0.5)
        start.observations.push_back(
            {v, p,
             test_camera().project_undistorted(start.views[v].cam_from_submap * start.points[p]) + scene.noise(0.7),
             1.0});
  for (Eigen::Vector3d& p : start.points) p *= 1 + scene.uniform(-0.02, 0.02);
  for (auto _ : state) {
    BundleProblem problem = start;
    benchmark::DoNotOptimize(solve_bundle(test_camera(), {}, &problem));
  }
}
BENCHMARK(BM_LocalBundle)->Arg(10)->Arg(20)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rumi
