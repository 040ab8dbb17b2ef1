// SPDX-License-Identifier: BSD-3-Clause
#include "synth/sequence_renderer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "base/or_throw.h"
#include "synth/camera_path.h"
#include "synth/campus_walk.h"
#include "synth/lens.h"
#include "synth/next_room_walk.h"
#include "synth/repeating_walks.h"
#include "synth/room_scene.h"
#include "synth/street_scene.h"

namespace rumi::synth {
namespace {

constexpr double kRamp_s = 0.25;                // time in which a hard passage sets in, and in which it ends
constexpr double kTurn_rad = 110 * M_PI / 180;  // how far a hard rotation turns, before it turns back
constexpr double kBlurPx = 5.0;  // standard deviation of the blur of a hard passage, at 640 pixels of width
constexpr double kDarkGain = 0.035;
constexpr double kExposureGain = 1.2;

// Returns how much of a hard passage's full effect there is t seconds after the first frame, 0 .. 1.
double amount(const HardPassage& passage, double t) {
  const double ramp = std::min(kRamp_s, passage.for_s / 4);
  const double inside = std::min(t - passage.at_s, passage.at_s + passage.for_s - t);
  return std::clamp(inside / ramp, 0.0, 1.0);
}

double amount(const std::vector<HardPassage>& passages, HardPassage::Kind kind, double t) {
  double most = 0;
  for (const HardPassage& passage : passages)
    if (passage.kind == kind) most = std::max(most, passage.strength * amount(passage, t));
  return most;
}

Walk make_walk(const SynthOptions& options) {
  or_throw(options.check());
  if (!options.path_file.empty()) return {.path = or_throw(CameraPath::load(options.path_file))};
  switch (options.walk) {
    case WalkKind::kNextRoom:
      return walk_to_next_room(options.seconds, options.seed);
    case WalkKind::kTwinRooms:
      return walk_to_twin_room(options.seconds, options.seed);
    case WalkKind::kStoreys:
      return walk_up_storeys(options.seconds, options.seed);
    case WalkKind::kDoors:
      return walk_past_doors(options.seconds, options.seed);
    case WalkKind::kSquare:
      return walk_round_square(options.seconds, options.seed);
    case WalkKind::kCampus:
      return {.path = walk_campus(options.seconds, options.seed)};
    case WalkKind::kLoop:
      break;
  }
  return {.path = CameraPath::walk(options.seconds, options.seed)};
}

}  // namespace

struct SequenceRenderer::Impl {
  explicit Impl(const SynthOptions& o) : Impl(o, make_walk(o)) {}

  Impl(const SynthOptions& o, Walk walk)
      : options(o),
        path(std::move(walk.path)),
        up(path.up()),
        lens(options.camera),
        sensor({options.camera.width, options.camera.height}, options.grey ? 1 : 3, options.noise) {
    for (HardPassage& passage : walk.hard) {
      passage.at_s -= options.start_s;
      options.hard.push_back(passage);
    }
    choose_times();
    first_s = times_s.front();
    if (options.scene == SceneKind::kRoom) {
      walk.path = path;
      scene = std::make_unique<RoomScene>(options, walk, lens.pinhole());
      return;
    }
    auto made = std::make_unique<StreetScene>(options, path, lens.pinhole());
    path = made->camera_path();
    street = made.get();
    scene = std::move(made);
  }

  void choose_times() {
    const std::vector<double>& all = path.times_s();
    const double begin = all.front() + options.start_s;
    const double end = options.duration_s > 0 ? std::min(all.back(), begin + options.duration_s) : all.back();
    if (begin >= end)
      throw std::runtime_error(
          fmt::format("start is {} s: the path lasts only {:.1f} s", options.start_s, all.back() - all.front()));
    const bool own_times = options.rate_hz == 0 && !options.path_file.empty();
    if (own_times) {
      for (const double t : all)
        if (t >= begin - 1e-9 && t <= end + 1e-9) times_s.push_back(t);
    } else {
      const double rate = options.rate_hz > 0 ? options.rate_hz : 30;
      for (int i = 0; begin + i / rate < end - 1e-9; ++i) times_s.push_back(begin + i / rate);
    }
    if (times_s.size() < 2 || times_s.back() <= times_s.front())
      throw std::runtime_error("the sequence has fewer than two frames; give more seconds or a higher rate");
  }

  SE3 pose(double t) const {
    SE3 map_from_cam = path.at(t);
    if (street) map_from_cam = street->shaken(map_from_cam, t);
    double turn = 0;
    for (const HardPassage& passage : options.hard) {
      if (passage.kind != HardPassage::Kind::kRotation) continue;
      const double phase = (t - first_s - passage.at_s) / passage.for_s;
      if (phase > 0 && phase < 1) turn += passage.strength * kTurn_rad * std::pow(std::sin(M_PI * phase), 2);
    }
    if (turn != 0) map_from_cam.rotation = (so3_exp(turn * up) * map_from_cam.rotation).normalized();
    return map_from_cam;
  }

  // Returns how much of a lorry's passage is over, 0 .. 1; -1 if there is none.
  double lorry_phase(double t) const {
    for (const HardPassage& passage : options.hard) {
      const double phase = (t - first_s - passage.at_s) / passage.for_s;
      if (passage.kind == HardPassage::Kind::kLorry && phase >= 0 && phase <= 1) return phase;
    }
    return -1;
  }

  // Returns how many images are averaged for the exposure: about one for every step by which the picture moves.
  int sub_exposures(double t) const {
    if (options.exposure_s <= 0) return 1;
    const SE3 move = pose(t - options.exposure_s / 2).inverse() * pose(t + options.exposure_s / 2);
    const double px = options.camera.fx * (move.angle_rad() + move.translation.norm() / scene->typical_depth_m());
    return std::clamp(static_cast<int>(std::ceil(px / scene->blur_step_px())), 1, options.max_sub_exposures);
  }

  void add_exposure(double t, double weight, double blankness, cv::Mat* sum) {
    scene->draw({pose(t), t, blankness, lorry_phase(t)}, &rgba);
    cv::cvtColor(rgba, plain, options.grey ? cv::COLOR_RGBA2GRAY : cv::COLOR_RGBA2BGR);
    lens.apply(plain, &bent);
    if (sum->empty())
      bent.convertTo(*sum, CV_32F, weight);
    else
      cv::accumulateWeighted(bent, *sum, weight);
  }

  SynthOptions options;
  CameraPath path;
  Eigen::Vector3d up;
  Lens lens;
  Sensor sensor;
  std::unique_ptr<Scene> scene;
  const StreetScene* street = nullptr;  // the scene, if it is a street
  std::vector<double> times_s;
  double first_s = 0;
  cv::Mat rgba, plain, bent;
};

SequenceRenderer::SequenceRenderer(const SynthOptions& options) : impl_(std::make_unique<Impl>(options)) {}
SequenceRenderer::~SequenceRenderer() = default;

int SequenceRenderer::frames() const { return static_cast<int>(impl_->times_s.size()); }
int64_t SequenceRenderer::utime_us(int frame) const { return std::llround(impl_->times_s.at(frame) * 1e6); }
SE3 SequenceRenderer::map_from_cam(int frame) const { return impl_->pose(impl_->times_s.at(frame)); }
const Camera& SequenceRenderer::camera() const { return impl_->options.camera; }

cv::Mat SequenceRenderer::render(int frame) {
  Impl& s = *impl_;
  const double t = s.times_s.at(frame), since_first = t - s.first_s;
  using Kind = HardPassage::Kind;
  const auto hard = [&](Kind kind) { return amount(s.options.hard, kind, since_first); };
  const int n = s.sub_exposures(t);
  cv::Mat sum;
  for (int k = 0; k < n; ++k) {
    const double offset = n > 1 ? s.options.exposure_s * ((k + 0.5) / n - 0.5) : 0;
    // The weight 1 / (k + 1) makes the sum the mean of the k + 1 images so far.
    s.add_exposure(t + offset, 1.0 / (k + 1), hard(Kind::kTextureless), &sum);
  }
  if (const double blur = hard(Kind::kBlur); blur > 0) {
    const double sigma = std::max(0.3, blur * kBlurPx * s.options.camera.width / 640);
    cv::GaussianBlur(sum, sum, {}, sigma, sigma, cv::BORDER_REPLICATE);
  }
  // A street has an automatic exposure, which depends on the time alone, so that parts of a path equal the whole.
  const double swing = s.street ? 0
                                : s.options.exposure_swing *
                                      std::sin(2 * M_PI * since_first / 9.7 + static_cast<double>(s.options.seed % 7));
  const double gain = s.scene->gain(t) * kExposureGain * (1 + swing) * (1 - (1 - kDarkGain) * hard(Kind::kDark));
  return s.sensor.expose(sum, gain, s.options.seed * 1000033 + static_cast<uint64_t>(frame));
}

}  // namespace rumi::synth
