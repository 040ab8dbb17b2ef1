// SPDX-License-Identifier: BSD-3-Clause
// A walk through a rendered room for the tracker, with the camera's true path.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/core.hpp>
#include <utility>
#include <vector>

#include "front_tracker/options.h"
#include "slam/geometry/alignment.h"
#include "slam/map/submap.h"
#include "synth/sequence_renderer.h"

namespace rumi::testing {
using namespace rumi::front_tracker;

struct RenderedWalk {
  std::vector<cv::Mat> images;
  std::vector<int64_t> utime_us;
  std::vector<SE3> cam_from_room;             // poses in metres
  std::map<int64_t, Eigen::Vector3d> center;  // the camera's centre in the room in metres, by utime
  Camera camera;
};

// `seed` determines the room and the path.
inline RenderedWalk render_walk(double seconds, double rate_hz, uint64_t seed = 1,
                                std::vector<synth::HardPassage> hard = {}) {
  synth::SynthOptions options;
  options.hard = std::move(hard);
  options.seed = seed;
  options.seconds = seconds;
  options.rate_hz = rate_hz;
  options.grey = true;
  options.camera = synth::default_synth_camera(320, 240);
  options.exposure_s = 0;
  synth::SequenceRenderer renderer(options);
  RenderedWalk made;
  made.camera = renderer.camera();
  for (int i = 0; i < renderer.frames(); ++i) {
    made.images.push_back(renderer.render(i));
    made.utime_us.push_back(renderer.utime_us(i));
    made.cam_from_room.push_back(renderer.map_from_cam(i).inverse());
    made.center[renderer.utime_us(i)] = renderer.map_from_cam(i).translation;
  }
  return made;
}

// Returns six seconds at 20 Hz, which are rendered once.
inline const RenderedWalk& rendered_walk() {
  static const RenderedWalk walk = render_walk(6, 20);
  return walk;
}

inline FrontTrackerOptions replay_options() {
  FrontTrackerOptions options;
  options.mapping_thread = false;
  return options;
}

struct Error {
  double rmse_m = 0, worst_m = 0;
  double path_m = 0;
  size_t frames = 0;
};

// Returns the errors of the submap's frames after aligning them with the truth.
inline Error error_of(const Submap& map, const std::map<int64_t, Eigen::Vector3d>& center) {
  std::vector<Eigen::Vector3d> estimated, truth;
  Error e;
  for (const auto& [utime, frame] : map.frames) {
    estimated.push_back(map.cam_from_submap(frame).center());
    if (!truth.empty()) e.path_m += (center.at(utime) - truth.back()).norm();
    truth.push_back(center.at(utime));
  }
  e.frames = estimated.size();
  const auto truth_from_submap = umeyama(estimated, truth);
  if (!truth_from_submap) return e;
  for (size_t i = 0; i < truth.size(); ++i) {
    const double error_m = (*truth_from_submap * estimated[i] - truth[i]).norm();
    e.rmse_m += error_m * error_m;
    e.worst_m = std::max(e.worst_m, error_m);
  }
  e.rmse_m = std::sqrt(e.rmse_m / static_cast<double>(truth.size()));
  return e;
}

}  // namespace rumi::testing
