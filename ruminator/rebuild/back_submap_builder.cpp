// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/rebuild/back_submap_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <map>
#include <set>

#include "base/running/stage_clock.h"
#include "base/this_process/cpu_clock.h"
#include "bus/wire/image_masks.h"
#include "bus/wire/working_image.h"
#include "ruminator/rebuild/back_landmarks.h"
#include "ruminator/rebuild/window_look.h"
#include "ruminator/rebuild/window_model.h"
#include "ruminator/rebuild/window_prospects.h"
#include "slam/features/lens_mask.h"

namespace rumi::ruminator {
namespace {

namespace fs = std::filesystem;

// Shares of the stages in the time of a build, as measured on windows of 20 to 120 images.
constexpr double kStageStart[] = {0.0, 0.3, 0.7, 1.0};

class Progress {
 public:
  explicit Progress(const std::function<void(const BuildProgress&)>& report) : report_(report) {}
  void operator()(BuildStage stage, double fraction) const {
    if (!report_) return;
    const auto s = static_cast<size_t>(stage);
    const double all = kStageStart[s] + fraction * (kStageStart[s + 1] - kStageStart[s]);
    const double remaining_s = all > 0.02 ? elapsed_s() * (1 - all) / all : -1;
    report_({stage, fraction, remaining_s});
  }
  double elapsed_s() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  const std::function<void(const BuildProgress&)>& report_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

struct WindowImages {
  std::vector<SeenImage> seen;
  std::vector<int64_t> utimes_us;
  std::vector<SiftFeatures> features;
  std::vector<WindowImage> colmap;
};

// `known`: features that are known already, by image.
WindowImages extract(const WindowJob& job, const Camera& camera, const BuildOptions& options,
                     const std::map<size_t, SiftFeatures>& known, const Progress& progress,
                     const std::atomic<bool>& cancel) {
  const StageClock clock("ruminator.sift");
  WindowImages images;
  MaskReader masks(lens_mask(camera));
  for (size_t i = 0; i < job.images.size() && !cancel; ++i) {
    progress(BuildStage::kExtracting, static_cast<double>(i) / static_cast<double>(job.images.size()));
    std::string ignored;
    const image_t& image = job.images[i];
    cv::Mat grey = decode_working_image(image, job.camera, camera, &ignored);
    if (grey.empty()) continue;  // broken, or of another camera
    const ImageMask& mask = masks.read(image, grey.size(), &ignored);
    const auto before = known.find(i);
    images.features.push_back(before != known.end() ? before->second
                                                    : extract_sift(grey, camera, options.sift_keypoints, mask));
    images.colmap.push_back({fmt::format("{}", image.utime), images.features.back().undistorted});
    images.utimes_us.push_back(image.utime);
    images.seen.push_back({image.utime, std::move(grey), mask});
  }
  return images;
}

std::set<int> all_of(size_t images) {
  std::set<int> all;
  for (size_t i = 0; i < images; ++i) all.insert(all.end(), static_cast<int>(i));
  return all;
}

std::vector<Sample> front_samples(const RuminationWindow& window) {
  std::vector<Sample> samples = window.samples();
  std::erase_if(samples, [](const Sample& sample) { return sample.submap_id == kNoSubmap; });
  return samples;
}

void count_registered(const RuminationWindow& window, const Submap& submap, BuildResult* result) {
  const auto registered = [&submap](const std::vector<Sample>& samples) {
    return static_cast<int>(std::count_if(samples.begin(), samples.end(),
                                          [&](const Sample& s) { return submap.frame(s.utime_us) != nullptr; }));
  };
  result->approach = registered(window.approach);
  result->gap = registered(window.gap);
  result->departure = registered(window.departure);
}

// All stages; result->failure or result->submap is set, or result->cancelled.
void run(const WindowJob& job, const BuildOptions& options, const std::string& work_folder, const Progress& progress,
         const std::atomic<bool>& cancel, BuildResult* result, double* child_cpu_s) {
  std::error_code error;
  fs::create_directories(work_folder, error);
  if (error) {
    result->failure = fmt::format("{}: cannot be made: {}", work_folder, error.message());
    result->retryable = true;
    return;
  }
  result->failure = find_blind_gap(job, options);
  if (!result->failure.empty()) return;
  const Camera camera = working_camera(job.camera, options.max_image_side);
  const WindowLook look = look_at_motion(job, camera, options, cancel);
  result->failure = look.hopeless;
  if (!result->failure.empty()) return;
  const WindowImages images = extract(job, camera, options, look.features, progress, cancel);
  const std::vector<ImagePair> pairs = match_window(
      camera, images.features, options.pairs,
      [&progress](double fraction) { progress(BuildStage::kMatching, fraction); }, cancel);
  if (!cancel) result->failure = find_hopeless(job, camera, images.utimes_us, images.features, pairs, options);
  if (!cancel && result->failure.empty())
    result->failure = find_no_depth(camera, images.features, pairs, all_of(images.features.size()), cancel);
  if (cancel || !result->failure.empty()) {
    result->cancelled = cancel;
    return;
  }
  progress(BuildStage::kMapping, 0);
  const std::vector<Sample> front = front_samples(job.window);
  const WindowModelResult model = build_window_model(
      {camera, images.colmap, images.utimes_us, pairs, front}, options, work_folder,
      [&progress](double fraction) { progress(BuildStage::kMapping, 0.9 * fraction); }, cancel);
  *child_cpu_s = model.child_cpu_s;
  result->models_tried = model.attempts;
  result->warning = model.warning;
  result->cancelled = model.cancelled;
  result->failure = model.failure;
  result->retryable = !model.failure.empty() && model.retryable;
  if (!model.failure.empty()) return;
  // What is published has a proof of its depth.
  std::set<int> in_model;
  for (const auto& [image, pose] : model.best.model.cam_from_world) in_model.insert(image);
  result->failure = find_no_depth(camera, images.features, pairs, in_model, cancel);
  if (!result->failure.empty()) return;

  Submap submap;
  submap.key = {job.window.session, -job.window.id};
  submap.stream = job.window.stream;
  submap.kind = SubmapKind::kBack;
  submap.camera = camera;
  submap.pyramid = options.pyramid;
  fill_back_submap(camera, images.seen, model.best.model, &submap);
  submap.close();
  result->error_px = model.best.quality.rmse_px;
  result->origin = model.best.origin;
  result->agreement = model.best.agreement;
  count_registered(job.window, submap, result);
  if (is_useful(result->approach, result->gap, result->departure))
    result->submap = std::move(submap);
  else
    result->failure = fmt::format("the {} images that have a pose bridge no gap", submap.frames.size());
}

}  // namespace

BuildResult build_back_submap(const WindowJob& job, const BuildOptions& options, const std::string& work_folder,
                              const std::function<void(const BuildProgress&)>& progress,
                              const std::atomic<bool>& cancel) {
  BuildResult result;
  const Progress tell(progress);
  const double start_cpu_s = thread_cpu_s();
  double child_cpu_s = 0;
  run(job, options, work_folder, tell, cancel, &result, &child_cpu_s);
  result.wall_s = tell.elapsed_s();
  result.cpu_s = thread_cpu_s() - start_cpu_s + child_cpu_s;
  if (result.failure.empty() || result.cancelled) {
    std::error_code ignored;
    fs::remove_all(work_folder, ignored);
  }
  return result;
}

}  // namespace rumi::ruminator
