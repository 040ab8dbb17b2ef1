// SPDX-License-Identifier: BSD-3-Clause
// Measures front_tracker alone on a recording: the CPU time of a frame beside that of cv::ORB on the same frames, how
// soon a submap begins at many places of the recording, how accurate such submaps are, and whether front_tracker finds
// the camera again after it was carried off.
#include <fmt/core.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/core/utility.hpp>
#include <opencv2/features2d.hpp>
#include <random>

#include "base/command_line/options.h"
#include "base/this_process/cpu_clock.h"
#include "bench/rendered_images.h"
#include "bus/wire/image_codec.h"
#include "camera_driver/open_source.h"
#include "camera_driver/source/image_source.h"
#include "formats/truth/truth.h"
#include "front_tracker/options.h"
#include "front_tracker/tracking/tracker.h"
#include "rumi/evaluation/metrics.h"

namespace rumi {
namespace {

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return NAN;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<size_t>(q * static_cast<double>(values.size())))];
}

struct Recording {
  Camera camera;
  std::vector<int64_t> utime_us;
  std::vector<cv::Mat> grey;
  std::vector<TimedPose> truth;
};

Recording read_recording(const std::string& folder, const camera_driver::CameraOptions& options, bool needs_truth) {
  Recording r;
  camera_driver::OpenedSource opened = camera_driver::open_image_source(folder, options);
  if (!opened) throw std::runtime_error(opened.error_text());
  r.camera = (*opened)->camera();
  while (const auto image = (*opened)->next()) {
    r.grey.push_back(decode_grey(*image).value());
    r.utime_us.push_back(image->utime);
  }
  if (!needs_truth) return r;
  TruthFile truth = read_groundtruth(folder + "/groundtruth.txt");
  if (!truth.ok()) throw std::runtime_error(truth.error);
  r.truth = std::move(truth.poses);
  return r;
}

Recording rendered_recording() {
  const RenderedImages& images = rendered_images();
  return {images.camera, images.utime_us, images.grey, images.truth};
}

struct SubmapResult {
  size_t frames = 0;
  double ate_m = NAN;
  double path_m = 0;
  double spread_m = 0;     // RMS distance of the true camera centres from their mean
  double scale_drift = 1;  // ratio between the scales of the submap's two halves, 1 or more
};

std::vector<TimedPose> poses_of(const Submap& map) {
  std::vector<TimedPose> poses;
  for (const auto& [utime, frame] : map.frames) poses.push_back({utime, map.cam_from_submap(frame).inverse()});
  return poses;
}

SubmapResult evaluate(const Submap& map, const std::vector<TimedPose>& truth) {
  const std::vector<TimedPose> estimate = poses_of(map);
  SubmapResult result;
  result.frames = estimate.size();
  const tool::TrajectoryMetrics metrics = tool::evaluate_trajectory(estimate, truth);
  if (!metrics.ate_rmse_m) return result;
  result.ate_m = *metrics.ate_rmse_m;
  result.path_m = metrics.path_m;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const tool::PoseError& e : metrics.errors) mean += e.truth_m / static_cast<double>(metrics.errors.size());
  for (const tool::PoseError& e : metrics.errors) result.spread_m += (e.truth_m - mean).squaredNorm();
  result.spread_m = std::sqrt(result.spread_m / static_cast<double>(metrics.errors.size()));
  const auto middle = estimate.begin() + static_cast<std::ptrdiff_t>(estimate.size() / 2);
  const auto first = tool::evaluate_trajectory({estimate.begin(), middle}, truth).truth_from_estimate;
  const auto second = tool::evaluate_trajectory({middle, estimate.end()}, truth).truth_from_estimate;
  if (first && second) result.scale_drift = std::exp(std::abs(std::log(first->scale / second->scale)));
  return result;
}

// One run of the tracker over a range of frames.
struct Run {
  int frames = 0;
  int begun_after = -1;          // number of frames before the first pose; -1: there is no pose
  std::vector<double> ms;        // CPU time of process() in its own thread, per frame
  std::vector<double> start_ms;  // as `ms`, but only for frames whose predecessor has no pose
  double cpu_ms = 0;             // CPU time of all threads
  std::vector<SubmapResult> submaps;
};

Run run(const Recording& r, const front_tracker::FrontTrackerOptions& options, size_t first, size_t last) {
  Run result;
  front_tracker::Tracker tracker(r.camera, options, 1);
  const double before_all_s = process_cpu_s();
  bool tracking = false;
  for (size_t i = first; i < last; ++i) {
    const double before_s = thread_cpu_s();
    const auto pose = tracker.process(r.utime_us[i], r.grey[i]);
    result.ms.push_back(1e3 * (thread_cpu_s() - before_s));
    if (!tracking) result.start_ms.push_back(result.ms.back());
    tracker.wait_for_mapping();
    tracking = pose && pose->state == TrackingState::kTracking;
    if (tracking && result.begun_after < 0) result.begun_after = result.frames;
    ++result.frames;
  }
  result.cpu_ms = 1e3 * (process_cpu_s() - before_all_s);
  for (const auto& submap : tracker.submaps()) result.submaps.push_back(evaluate(submap->map, r.truth));
  return result;
}

double orb_ms_per_frame(const Recording& r) {
  const auto orb = cv::ORB::create(1000);
  const double before_s = process_cpu_s();
  for (const cv::Mat& grey : r.grey) {
    std::vector<cv::KeyPoint> keypoints;
    cv::Mat descriptors;
    orb->detectAndCompute(grey, cv::noArray(), keypoints, descriptors);
  }
  return 1e3 * (process_cpu_s() - before_s) / static_cast<double>(r.grey.size());
}

void bench_whole(const Recording& r, const front_tracker::FrontTrackerOptions& options) {
  const Run whole = run(r, options, 0, r.grey.size());
  const double cpu_ms = whole.cpu_ms / whole.frames, orb_ms = orb_ms_per_frame(r);
  fmt::print("{} frames, CPU per frame {:.2f} ms (all threads), cv::ORB(1000) {:.2f} ms, ratio {:.2f}\n", whole.frames,
             cpu_ms, orb_ms, cpu_ms / orb_ms);
  const auto quantiles = [](const char* name, const std::vector<double>& ms) {
    fmt::print("process(), {} {} frames: median {:.1f} ms, 95 % {:.1f} ms, worst {:.1f} ms\n", ms.size(), name,
               quantile(ms, 0.5), quantile(ms, 0.95), quantile(ms, 1));
  };
  quantiles("all", whole.ms);
  quantiles("untracked", whole.start_ms);
  size_t posed = 0;
  double squares_m2 = 0;
  for (const SubmapResult& s : whole.submaps) {
    posed += s.frames;
    if (!std::isnan(s.ate_m)) squares_m2 += static_cast<double>(s.frames) * s.ate_m * s.ate_m;
    fmt::print("submap: {} frames, path {:.2f} m, ATE {:.4f} m\n", s.frames, s.path_m, s.ate_m);
  }
  fmt::print("{} of {} frames in {} submaps, {:.4f} m over all of them, first pose after {}\n", posed, whole.frames,
             whole.submaps.size(), std::sqrt(squares_m2 / static_cast<double>(posed)), whole.begun_after);
}

void bench_starts(const Recording& r, const front_tracker::FrontTrackerOptions& options, int starts, size_t frames,
                  bool verbose) {
  std::mt19937 rng(7);
  std::vector<double> after, error, ate, drift, ms;
  int diverged = 0;
  double posed = 0;
  frames = std::min(frames, r.grey.size());
  for (int i = 0; i < starts; ++i) {
    const size_t first = rng() % (r.grey.size() - frames + 1);
    const Run one = run(r, options, first, first + frames);
    ms.insert(ms.end(), one.start_ms.begin(), one.start_ms.end());
    if (one.submaps.empty()) {
      if (verbose) fmt::print("{:5} not begun\n", first);
      continue;
    }
    const SubmapResult& s = one.submaps.front();
    posed += static_cast<double>(s.frames) / static_cast<double>(frames * starts);
    after.push_back(one.begun_after);
    if (std::isnan(s.ate_m)) continue;
    ate.push_back(s.ate_m);
    error.push_back(s.ate_m / s.spread_m);
    drift.push_back(s.scale_drift);
    diverged += s.ate_m > 0.05 * s.path_m;
    if (verbose)
      fmt::print("{:5} after {:3}, {:3} frames of {} submaps, ATE {:.4f} m, {:.3f} of spread {:.2f} m, drift {:.2f}\n",
                 first, one.begun_after, s.frames, one.submaps.size(), s.ate_m, error.back(), s.spread_m,
                 s.scale_drift);
  }
  fmt::print(
      "{} of {} starts began within {} frames, after median {:.0f}, 90 % {:.0f}; {:.1f} % of frames in the first "
      "submap\n",
      after.size(), starts, frames, quantile(after, 0.5), quantile(after, 0.9), 100 * posed);
  const auto print = [](const char* name, const std::vector<double>& v) {
    fmt::print("{}: median {:.4f}, 75 % {:.4f}, 90 % {:.4f}, worst {:.4f}\n", name, quantile(v, 0.5), quantile(v, 0.75),
               quantile(v, 0.9), quantile(v, 1));
  };
  print("  ATE, m            ", ate);
  print("  ATE / spread      ", error);
  print("  scale drift, ratio", drift);
  fmt::print("  ATE above 5 % of the path: {}\n", diverged);
  fmt::print("  process() without a submap: median {:.1f} ms, 95 % {:.1f} ms, worst {:.1f} ms\n", quantile(ms, 0.5),
             quantile(ms, 0.95), quantile(ms, 1));
}

// Maps the whole recording, then carries the camera off to random places of it: plays one second from each.
void bench_kidnaps(const Recording& r, const front_tracker::FrontTrackerOptions& options, int jumps) {
  constexpr double kWrong_m = 0.3;
  front_tracker::Tracker tracker(r.camera, options, 1);
  int64_t utime_us = 0;
  const int64_t period_us = (r.utime_us.back() - r.utime_us.front()) / static_cast<int64_t>(r.utime_us.size() - 1);
  const auto give = [&](size_t frame) {
    auto result = tracker.process(utime_us += period_us, r.grey[frame]);
    tracker.wait_for_mapping();
    return result;
  };
  std::vector<TimedPose> truth;  // true pose of each frame, at the time with which the tracker gets it
  for (size_t i = 0; i < r.grey.size(); ++i) {
    give(i);
    const auto at = std::lower_bound(r.truth.begin(), r.truth.end(), r.utime_us[i] - period_us / 2,
                                     [](const TimedPose& pose, int64_t utime) { return pose.utime_us < utime; });
    if (at == r.truth.end()) throw std::runtime_error("the truth ends before the recording");
    truth.push_back({utime_us, at->map_from_cam});
  }
  std::map<int, Sim3> truth_from_submap;
  for (const auto& submap : tracker.submaps())
    if (const auto aligned = tool::evaluate_trajectory(poses_of(submap->map), truth).truth_from_estimate)
      truth_from_submap[submap->map.key.id] = *aligned;

  const size_t second = static_cast<size_t>(1'000'000 / period_us);
  std::mt19937 rng(11);
  int found = 0, wrong = 0, wrong_jumps = 0, elsewhere = 0;
  std::vector<double> after_s, error_m;
  for (int jump = 0; jump < jumps; ++jump) {
    const size_t first = rng() % (r.grey.size() - second);
    bool is_found = false, is_wrong = false;
    for (size_t i = 0; i < second; ++i) {
      const auto result = give(first + i);
      if (!result || result->submap_id == kNoSubmap) continue;
      const auto aligned = truth_from_submap.find(result->submap_id);
      if (aligned == truth_from_submap.end()) {
        ++elsewhere;
        continue;
      }
      const Eigen::Vector3d center = aligned->second * result->cam_from_submap.center();
      error_m.push_back((center - truth[first + i].map_from_cam.translation).norm());
      wrong += error_m.back() > kWrong_m;
      is_wrong |= error_m.back() > kWrong_m;
      if (!is_found) after_s.push_back(1e-6 * static_cast<double>(period_us) * static_cast<double>(i));
      is_found = true;
    }
    found += is_found;
    wrong_jumps += is_wrong;
  }
  fmt::print(
      "{} of {} jumps found within a second, after median {:.3f} s, 90 % {:.3f} s\n{} of {} poses more than {} m off, "
      "in "
      "{} jumps; error median {:.3f} m, worst {:.3f} m; {} poses in submaps begun meanwhile\n",
      found, jumps, quantile(after_s, 0.5), quantile(after_s, 0.9), wrong, error_m.size(), kWrong_m, wrong_jumps,
      quantile(error_m, 0.5), quantile(error_m, 1), elsewhere);
}

int main_of(int argc, char** argv) {
  CLI::App app("Speed and starts of the front tracker on a recording; without one, on a rendered walk.");
  std::string folder;
  int starts = 0, jumps = 0;
  size_t frames = 120;
  bool verbose = false, only_orb = false;
  front_tracker::FrontTrackerOptions options;
  camera_driver::CameraOptions part;
  OptionTable table;
  describe(table, options);
  std::vector<std::string> settings;
  app.add_option("recording", folder, "as for `rumi replay`, with a groundtruth.txt");
  app.add_option("--start", part.start_s, "leave out so much at the beginning, s");
  app.add_option("--every", part.every, "every Nth frame only");
  app.add_option("--starts", starts, "begin at so many random frames instead of running the whole");
  app.add_option("--frames", frames, "of each start")->capture_default_str();
  app.add_option("--kidnap", jumps, "map the whole, then jump to so many random places of it");
  app.add_flag("--orb", only_orb, "cv::ORB(1000) alone; needs no groundtruth.txt");
  app.add_option("--set", settings, "key=value of an option");
  app.add_flag("-v", verbose, "say every start, and what the tracker does");
  CLI11_PARSE(app, argc, argv);
  for (const std::string& setting : settings)
    if (const std::string error = table.set(setting); !error.empty()) throw std::runtime_error(error);
  spdlog::set_level(verbose ? spdlog::level::debug : spdlog::level::warn);
  cv::setNumThreads(1);
  const Recording recording = folder.empty() ? rendered_recording() : read_recording(folder, part, !only_orb);
  if (only_orb)
    fmt::print("cv::ORB(1000) {:.2f} ms\n", orb_ms_per_frame(recording));
  else if (starts > 0)
    bench_starts(recording, options, starts, frames, verbose);
  else if (jumps > 0)
    bench_kidnaps(recording, options, jumps);
  else
    bench_whole(recording, options);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  double images_mb = 0;
  for (const cv::Mat& grey : recording.grey) images_mb += 1e-6 * static_cast<double>(grey.total());
  fmt::print("peak memory {:.0f} MB, of which {:.0f} MB are the recording's images\n",
             1.024e-3 * static_cast<double>(usage.ru_maxrss), images_mb);
  return 0;
}

}  // namespace
}  // namespace rumi

int main(int argc, char** argv) {
  try {
    return rumi::main_of(argc, argv);
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}\n", e.what());
    return 1;
  }
}
