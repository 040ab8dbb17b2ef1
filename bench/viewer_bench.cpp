// SPDX-License-Identifier: BSD-3-Clause
// Measures how fast viewer_offscreen draws a map of 100 000 landmarks, 1000 keyframes and 10 000 frames at 1280 x 720:
// all work for one picture, and each part of it.
#include <benchmark/benchmark.h>

#include <opencv2/imgcodecs.hpp>

#include "bus/wire/jpeg_image.h"
#include "tests/viewer_offscreen/test_map.h"
#include "viewer_offscreen/picture/draw_map.h"
#include "viewer_offscreen/picture/renderer.h"

namespace rumi {
namespace {

// kKeypoints: per keyframe; kTrack: keyframes that see a landmark.
constexpr int kLandmarks = 100'000, kKeypoints = 800, kTrack = 8;

Submap large_submap() {
  Submap submap = viewer_offscreen::make_test_submap(1, 0, 10'000 / 30.0, viewer_offscreen::test_circle, kLandmarks);
  std::map<int, int> used;
  for (auto& [id, keyframe] : submap.keyframes) {
    auto features = std::make_shared<Features>();
    features->keypoints.resize(kKeypoints);
    keyframe.features = features;
    keyframe.landmark_ids.assign(kKeypoints, kNone);
  }
  const int keyframes = static_cast<int>(submap.keyframes.size());
  for (int id = 0; id < kLandmarks; ++id) {
    const int first = static_cast<int>(static_cast<int64_t>(id) * keyframes / kLandmarks);
    for (int k = first; k < std::min(keyframes, first + kTrack); ++k)
      if (used[k] < kKeypoints) submap.add_observation(id, k, used[k]++);
  }
  return submap;
}

const Submap& shared_submap() {
  static const Submap submap = large_submap();
  return submap;
}

viewer_offscreen::MapPicture shared_picture() {
  viewer_offscreen::MapPicture picture{.submaps = {{&shared_submap(), true}},
                                       .frames = viewer_offscreen::test_frames(0, 10'000 / 30.0)};
  picture.camera_view.image = cv::Mat(480, 640, CV_8UC3, cv::Scalar::all(120));
  return picture;
}

void BM_Scene(benchmark::State& state) {
  const viewer_offscreen::MapPicture picture = shared_picture();
  for (auto _ : state) benchmark::DoNotOptimize(viewer_offscreen::make_scene(picture));
}

void BM_Draw(benchmark::State& state) {
  const viewer_offscreen::Scene scene = viewer_offscreen::make_scene(shared_picture());
  viewer_offscreen::Renderer renderer;
  for (auto _ : state) benchmark::DoNotOptimize(renderer.draw(scene));
}

void BM_Jpeg(benchmark::State& state) {
  const cv::Mat image = viewer_offscreen::draw_map(shared_picture());
  for (auto _ : state) benchmark::DoNotOptimize(make_jpeg_image(0, image, 90));
}

void BM_Png(benchmark::State& state) {
  const cv::Mat image = viewer_offscreen::draw_map(shared_picture());
  for (auto _ : state) benchmark::DoNotOptimize(viewer_offscreen::encode_png(image));
}

void BM_WholePicture(benchmark::State& state) {
  const viewer_offscreen::MapPicture picture = shared_picture();
  viewer_offscreen::Renderer renderer;
  for (auto _ : state) {
    const cv::Mat image = renderer.draw(viewer_offscreen::make_scene(picture));
    benchmark::DoNotOptimize(make_jpeg_image(0, image, 90));
    benchmark::DoNotOptimize(viewer_offscreen::encode_png(image));
  }
  state.counters["pictures/s"] =
      benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

BENCHMARK(BM_Scene)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
BENCHMARK(BM_Draw)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
BENCHMARK(BM_Jpeg)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
BENCHMARK(BM_Png)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
BENCHMARK(BM_WholePicture)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

}  // namespace
}  // namespace rumi
