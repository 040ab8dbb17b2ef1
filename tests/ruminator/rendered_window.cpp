// SPDX-License-Identifier: BSD-3-Clause
#include "tests/ruminator/rendered_window.h"

#include <opencv2/imgproc.hpp>

#include "bus/wire/jpeg_image.h"
#include "synth/sequence_renderer.h"

namespace rumi::testing {
using namespace rumi::ruminator;
namespace {

constexpr int kApproach = 7, kGap = 6, kFrames = 20;
constexpr int kJpegQuality = 92;

RenderedWindow render() {
  synth::SynthOptions options;
  options.seed = 4;
  options.seconds = 5;
  options.rate_hz = 4;
  options.camera = synth::default_synth_camera(320, 240);
  options.camera.k1 = -0.05;
  options.exposure_s = 0;
  options.grey = true;
  synth::SequenceRenderer renderer(options);

  RenderedWindow window;
  window.job.camera = renderer.camera();
  RuminationWindow& w = window.job.window;
  w.id = 3;
  w.session = 77;
  w.submap_before = 1;
  w.submap_after = 2;
  w.reason = "departure complete";
  for (int i = 0; i < kFrames; ++i) {
    const SE3 cam_from_map = renderer.map_from_cam(i).inverse();
    const bool in_gap = i >= kApproach && i < kApproach + kGap;
    cv::Mat grey = renderer.render(i);
    if (in_gap) cv::GaussianBlur(grey, grey, {}, 1.2);
    window.job.images.push_back(make_jpeg_image(renderer.utime_us(i), grey, kJpegQuality));
    window.cam_from_map.push_back(cam_from_map);
    Sample sample{.utime_us = renderer.utime_us(i)};
    if (!in_gap) sample.submap_id = i < kApproach ? 1 : 2;
    if (!in_gap) sample.cam_from_submap = cam_from_map;
    (in_gap ? w.gap : i < kApproach ? w.approach : w.departure).push_back(sample);
  }
  w.gap_frames = kGap;
  w.lost_utime_us = w.gap.front().utime_us;
  w.resumed_utime_us = w.departure.front().utime_us;
  return window;
}

}  // namespace

const RenderedWindow& rendered_window() {
  static const RenderedWindow window = render();
  return window;
}

void replace_image(WindowJob* job, size_t index, const cv::Mat& grey) {
  job->images[index] = make_jpeg_image(job->images[index].utime, grey, kJpegQuality);
}

}  // namespace rumi::testing
