// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/rebuild/back_submap_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/running/stage_clock.h"
#include "base/this_process/cpu_clock.h"
#include "bus/wire/working_image.h"
#include "ruminator/rebuild/back_landmarks.h"
#include "ruminator/rebuild/window_images.h"
#include "ruminator/rebuild/window_model.h"
#include "ruminator/rebuild/window_prospects.h"

namespace rumi::ruminator {
namespace {

namespace fs = std::filesystem;

// Fractions of the build time at which the stages begin and the last one ends, as measured on windows of 20 to 120
// images.
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

std::vector<Sample> front_samples(const RuminationWindow& window) {
  std::vector<Sample> samples = window.samples();
  std::erase_if(samples, [](const Sample& sample) { return sample.submap_id == kNoSubmap; });
  return samples;
}

class BackSubmapBuild {
 public:
  BackSubmapBuild(const WindowJob& job, const BuildOptions& options, const std::string& work_folder,
                  const Progress& progress, const std::atomic<bool>& cancel)
      : job_(job),
        options_(options),
        work_folder_(work_folder),
        progress_(progress),
        cancel_(cancel),
        camera_(working_camera(job.camera, options.max_image_side)),
        prospects_(job_, camera_, options_, cancel_),
        images_(job_, camera_, options.sift_keypoints) {}

  BuildResult run() {
    const double start_cpu_s = thread_cpu_s();
    result_.submap = rebuild();
    result_.wall_s = progress_.elapsed_s();
    result_.cpu_s = thread_cpu_s() - start_cpu_s + child_cpu_s_;
    return std::move(result_);
  }

 private:
  using Step = Result<> (BackSubmapBuild::*)();

  Result<Submap> rebuild() {
    using Build = BackSubmapBuild;
    for (const Step step : {&Build::make_work_folder, &Build::look, &Build::match, &Build::judge_matches,
                            &Build::find_model, &Build::judge_model})
      if (const Result<> done = (this->*step)(); !done) return done.error();
    return back_submap();
  }

  Result<> make_work_folder() {
    std::error_code error;
    fs::create_directories(work_folder_, error);
    if (!error) return {};
    result_.retryable = true;
    return Error{fmt::format("cannot be made: {}", error.message()), work_folder_};
  }

  Result<> look() { return prospects_.at_first_look(images_); }

  Result<> match() {
    extract();
    pairs_ = match_window(
        camera_, usable_.features, options_.pairs,
        [this](double fraction) { progress_(BuildStage::kMatching, fraction); }, cancel_);
    return {};
  }

  void extract() {
    const StageClock clock("ruminator.sift");
    for (size_t i = 0; i < images_.size() && !cancel_; ++i) {
      progress_(BuildStage::kExtracting, static_cast<double>(i) / static_cast<double>(images_.size()));
      images_.features(i);
    }
    usable_ = images_.take();
  }

  Result<> judge_matches() {
    const Result<> prospect = cancel_ ? Result<>() : prospects_.of_matches(usable_, pairs_);
    if (!cancel_) return prospect;
    result_.cancelled = true;
    return Error{"called off"};
  }

  Result<> find_model() {
    progress_(BuildStage::kMapping, 0);
    const std::vector<Sample> front = front_samples(job_.window);
    WindowModelResult found = build_window_model(
        {camera_, usable_.colmap, usable_.utimes_us, pairs_, front, job_.window.by_place}, options_, work_folder_,
        [this](double fraction) { progress_(BuildStage::kMapping, 0.9 * fraction); }, cancel_);
    child_cpu_s_ = found.child_cpu_s;
    result_.models_tried = found.attempts;
    result_.warning = found.warning;
    result_.cancelled = found.cancelled;
    result_.retryable = !found.best && found.retryable;
    if (!found.best) return found.best.error();
    model_ = std::move(*found.best);
    return {};
  }

  Result<> judge_model() {
    if (Result<> depth = prospects_.of_model(usable_, pairs_, model_.model); !depth) return depth;
    result_.error_px = model_.quality.rmse_px;
    result_.origin = model_.origin;
    result_.agreement = model_.agreement;
    count_registered();
    if (is_useful(result_.approach, result_.gap, result_.departure)) return {};
    return Error{fmt::format("the {} images that have a pose bridge no gap", model_.model.cam_from_world.size())};
  }

  void count_registered() {
    std::set<int64_t> utimes;
    for (const auto& [image, pose] : model_.model.cam_from_world) utimes.insert(usable_.utimes_us[image]);
    const auto registered = [&utimes](const std::vector<Sample>& samples) {
      return static_cast<int>(
          std::count_if(samples.begin(), samples.end(), [&](const Sample& s) { return utimes.contains(s.utime_us); }));
    };
    result_.approach = registered(job_.window.approach);
    result_.gap = registered(job_.window.gap);
    result_.departure = registered(job_.window.departure);
  }

  Submap back_submap() const {
    Submap submap;
    submap.key = {job_.window.session, -job_.window.id};
    submap.stream = job_.window.stream;
    submap.kind = SubmapKind::kBack;
    submap.camera = camera_;
    submap.pyramid = options_.pyramid;
    submap.close();
    fill_back_submap(camera_, usable_.seen, model_.model, &submap);
    return submap;
  }

  const WindowJob& job_;
  const BuildOptions& options_;
  const std::string& work_folder_;
  const Progress& progress_;
  const std::atomic<bool>& cancel_;
  const Camera camera_;  // the working camera
  WindowProspects prospects_;
  WindowImages images_;
  UsableImages usable_;
  std::vector<ImagePair> pairs_;
  WindowModel model_;
  double child_cpu_s_ = 0;
  BuildResult result_;
};

}  // namespace

BuildResult build_back_submap(const WindowJob& job, const BuildOptions& options, const std::string& work_folder,
                              const std::function<void(const BuildProgress&)>& progress,
                              const std::atomic<bool>& cancel) {
  const Progress tell(progress);
  BuildResult result = BackSubmapBuild(job, options, work_folder, tell, cancel).run();
  if (result.submap || result.cancelled) {
    std::error_code ignored;
    fs::remove_all(work_folder, ignored);
  }
  return result;
}

}  // namespace rumi::ruminator
