// SPDX-License-Identifier: BSD-3-Clause
// Measures the CPU time per image of the whole front_tracker, including mapping, over 90 images from a cold start.
#include <benchmark/benchmark.h>
#include <spdlog/spdlog.h>

#include "bench/rendered_images.h"
#include "front_tracker/options.h"
#include "front_tracker/tracking/tracker.h"

namespace rumi {
namespace {

void BM_TrackerPerImage(benchmark::State& state) {
  spdlog::set_level(spdlog::level::warn);
  front_tracker::FrontTrackerOptions options;
  options.mapping_thread = false;
  const RenderedImages& images = rendered_images();
  for (auto _ : state) {
    front_tracker::Tracker tracker(images.camera, options, 1);
    for (size_t i = 0; i < images.grey.size(); ++i)
      benchmark::DoNotOptimize(tracker.process(images.utime_us[i], images.grey[i]));
  }
  // The benchmark prints images per second of CPU time.
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(images.grey.size()));
}
BENCHMARK(BM_TrackerPerImage)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rumi
