// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz/good_window.h"

#include <fstream>
#include <iterator>

#include "base/or_throw.h"
#include "fuzz/good_messages.h"
#include "fuzz/scratch.h"

namespace rumi::fuzz {

Bytes good_window_file(int frames) {
  ruminator::WindowJob job;
  job.camera = good_camera();
  job.window.id = 1;
  job.window.session = kSession;
  job.window.submap_before = 1;
  job.window.submap_after = 2;
  job.window.gap_frames = frames;
  int64_t utime_us = kSession;
  for (auto* part : {&job.window.approach, &job.window.gap, &job.window.departure}) {
    for (int i = 0; i < frames; ++i) {
      ruminator::Sample& sample = part->emplace_back();
      sample.utime_us = utime_us += 100'000;
      sample.submap_id = part == &job.window.gap ? kNoSubmap : 1;
      job.images.push_back(good_jpeg(utime_us));
    }
  }
  const std::string file = scratch() / "good.window";
  or_throw(write_window_job(file, job));
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace rumi::fuzz
