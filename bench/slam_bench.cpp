// SPDX-License-Identifier: BSD-3-Clause
// Measures the expensive parts one by one: keypoints (and OpenCV's ORB on the same image), matching, pose optimization,
// bundle adjustment, Sim(3) refinement, and the Sim(3) graph that joins submaps.
#include <benchmark/benchmark.h>

#include <opencv2/core/utility.hpp>
#include <opencv2/features2d.hpp>

#include "bench/rendered_images.h"
#include "slam/features/matching.h"
#include "slam/features/orb_extractor.h"
#include "slam/optimization/bundle_adjustment.h"
#include "slam/optimization/pose_optimizer.h"
#include "slam/optimization/sim3_graph.h"
#include "slam/optimization/sim3_refinement.h"
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
  OrbExtractor extractor({});
  const cv::Mat& grey = rendered_images().grey[0];
  for (auto _ : state) benchmark::DoNotOptimize(extractor.extract(grey, static_cast<int>(state.range(0))));
}
BENCHMARK(BM_OrbExtractor)->Arg(1000)->Arg(2000)->Unit(benchmark::kMillisecond);

void BM_MatchAllWithAll(benchmark::State& state) {
  OrbExtractor extractor({});
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

// Points of each of two submaps are observed from the other one; 30 % of the observations are false.
void BM_RefineSim3(benchmark::State& state) {
  SyntheticScene scene(3);
  const Sim3 truth(2.5, so3_exp({0.4, -1.0, 0.3}), Eigen::Vector3d(2, -1, 3));
  Sim3RefinementProblem problem;
  const auto see = [&](const SE3& cam_from_a, const Eigen::Vector3d& p) {
    if (scene.uniform(0, 1) < 0.3) return Eigen::Vector2d(scene.uniform(0, 640), scene.uniform(0, 480));
    return Eigen::Vector2d(test_camera().project_undistorted(cam_from_a * p) + scene.noise(1));
  };
  for (const Eigen::Vector3d& p : scene.cloud(static_cast<int>(state.range(0)))) {
    const SE3 cam_from_a = SyntheticScene::pose(scene.uniform(0, 1), scene.uniform(0, 0.2), 0);
    problem.a_into_b.push_back({p, truth.transform_camera(cam_from_a), see(cam_from_a, p), 1.0});
    problem.b_into_a.push_back({truth * p, cam_from_a, see(cam_from_a, p), 1.0});
  }
  Vector7d off;
  off << 0.03, -0.03, 0.02, 0.3, -0.2, 0.3, 0.06;
  for (auto _ : state) {
    Sim3 b_from_a = truth.plus(off);
    if (!refine_sim3(test_camera(), {}, problem, &b_from_a).usable) state.SkipWithError("not usable");
  }
}
BENCHMARK(BM_RefineSim3)->Arg(100)->Arg(1000)->Unit(benchmark::kMillisecond);

Sim3Graph::Edge measured_edge(SyntheticScene& scene, const std::vector<Sim3>& truth, int first, int second) {
  Vector7d error;
  for (int k = 0; k < 7; ++k) error[k] = scene.uniform(-0.01, 0.01);
  Sim3Graph::Edge e;
  e.first = first;
  e.second = second;
  e.second_from_first = (truth[second].inverse() * truth[first]).plus(error);
  e.sigma_rotation_rad = e.sigma_translation = e.sigma_log_scale = 0.006;
  return e;
}

// Ten laps of a round course. Each node is measured against its three predecessors and the node beside it in the lap
// before. Before optimization, the nodes of the first lap are chained by their measurements and drift; each later node
// is placed by its measurement against the node beside it.
void BM_Sim3Graph(benchmark::State& state) {
  SyntheticScene scene(4);
  const int count = static_cast<int>(state.range(0)), lap = count / 10;
  std::vector<Sim3> truth;
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * M_PI * i / lap, radius = lap / (2 * M_PI) + 0.5 * i / lap;
    truth.emplace_back(1.0, so3_exp({0, -angle, 0}), radius * Eigen::Vector3d(std::cos(angle), 0, std::sin(angle)));
  }
  Sim3Graph start;
  start.nodes.push_back({truth[0], true});
  for (int i = 1; i < count; ++i) {
    start.edges.push_back(measured_edge(scene, truth, i - 1, i));
    if (i >= lap) start.edges.push_back(measured_edge(scene, truth, i - lap, i));
    const Sim3Graph::Edge& e = start.edges.back();
    start.nodes.push_back({start.nodes[e.first].map_from_node * e.second_from_first.inverse(), false});
  }
  for (int i = 2; i < count; ++i) {
    start.edges.push_back(measured_edge(scene, truth, i - 2, i));
    if (i >= 3) start.edges.push_back(measured_edge(scene, truth, i - 3, i));
  }
  Sim3GraphReport report;
  double worst = 0;
  for (auto _ : state) {
    Sim3Graph graph = start;
    report = solve_sim3_graph({}, &graph);
    if (!report.usable) state.SkipWithError("not usable");
    for (int i = 0; i < count; ++i)
      worst = std::max(worst, (graph.nodes[i].map_from_node.translation - truth[i].translation).norm());
  }
  state.counters["edges"] = static_cast<double>(start.edges.size());
  state.counters["solver_iterations"] = report.iterations;
  state.counters["converged"] = report.converged;
  state.counters["worst_error"] = worst;
}
BENCHMARK(BM_Sim3Graph)->Arg(100)->Arg(1000)->Arg(10000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rumi
