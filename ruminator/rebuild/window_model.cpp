// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/rebuild/window_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <set>
#include <utility>

#include "base/running/log.h"
#include "base/running/stage_clock.h"
#include "ruminator/colmap/write_model.h"
#include "ruminator/model/model_agreement.h"
#include "ruminator/rebuild/model_completion.h"

namespace rumi::ruminator {
namespace {

namespace fs = std::filesystem;

constexpr double kCompleteRatio = 0.95;  // a model with this share of the connected images needs no further attempts
constexpr double kEnoughByPlace = 0.5;   // the same for windows by place
// A mapper whose wall-clock time exceeds its CPU limit by this factor hangs; below it, other programs may use the
// cores.
constexpr double kWallPerCpuTime = 30;

// Models that COLMAP's mapper began itself, by the angle of its first pair, before completion.
using ColmapModels = std::map<double, std::vector<SparseModel>>;

class Attempts {
 public:
  Attempts(const WindowModelInput& input, const BuildOptions& options, const std::string& folder,
           const std::atomic<bool>& cancel, ColmapModels* colmap_models)
      : in_(input),
        o_(options),
        folder_(folder),
        cancel_(cancel),
        colmap_models_(*colmap_models),
        mapper_(options.colmap_program ? options.colmap_program : std::make_shared<ColmapProgram>(options.colmap)),
        completion_(input, options) {
    rotations_ = relative_rotations(in_.camera, in_.images, in_.pairs);
    for (const WindowImage& image : in_.images) keypoint_counts_.push_back(static_cast<int>(image.keypoints.size()));
    const std::vector<int> group = connected_images(static_cast<int>(in_.images.size()), in_.pairs, 1);
    connected_ = static_cast<int>(std::count(group.begin(), group.end(), 0));
  }

  // Extends what the map knows of the window by further images.
  void map() {
    SparseModel known;
    for (const Sample& sample : in_.front)
      if (const std::optional<int> image = in_.image_of(sample); image && sample.submap_id == kMapFrame)
        known.cam_from_world.emplace(*image, sample.cam_from_submap);
    if (known.cam_from_world.empty()) return;
    ++result.attempts;
    WindowModel candidate = completion_.complete(std::move(known), "the map's poses");
    candidate.begun = WindowModel::Beginning::kMap;
    judge_model(in_, rotations_, o_, &candidate);
    keep(std::move(candidate));
  }

  // Builds the global model, and lets COLMAP extend it.
  void global() {
    auto model = build_global_model(in_.camera, in_.images, rotations_, o_.global_track_images);
    ++result.attempts;
    if (!model || cancel_) return;
    // The global model is rough, so it is pruned and adjusted with decreasing limits for errors.
    for (double max_error_px : {50.0, 10.0}) {
      ModelRefinementOptions rough = o_.refinement;
      rough.max_error_px = max_error_px;
      prune_model(in_.camera, in_.images, rough, &*model);
      adjust_model(in_.camera, in_.images, rough, &*model);
    }
    WindowModel ours = completion_.complete(std::move(*model), "global model");
    const std::string seed = folder_ + "/seed";
    std::error_code ignored;
    fs::create_directories(seed, ignored);
    if (const Result<> written = write_colmap_model(seed, in_.camera, in_.images, ours.model); !written)
      result.warning = written.error_text();
    else
      extend(seed, &ours);
    add_global(std::move(ours));
  }

  void colmap_alone(double angle_deg) {
    if (!colmap_models_.contains(angle_deg)) {
      MapperSettings settings = common_settings();
      settings.init_min_tri_angle_deg = angle_deg;
      MapperOutcome outcome = run_mapper("", settings);
      if (!outcome.models) return;
      colmap_models_[angle_deg] = std::move(*outcome.models);
    }
    const std::vector<SparseModel>& models = colmap_models_.at(angle_deg);
    const std::string origin = fmt::format("COLMAP, first pair at {:.0f} degrees", angle_deg);
    for (const SparseModel& model : models) add_rival(completion_.complete(model, origin));
    for (const SparseModel& model : completion_.joined(models))
      add_rival(completion_.complete(model, origin + ", two models joined"));
  }

  bool is_enough() const {
    const double enough = (in_.by_place ? kEnoughByPlace : kCompleteRatio) * connected_;
    if (in_.needs_witness()) return static_cast<double>(most_confirmed().images.size()) >= enough;
    return std::any_of(candidates_.begin(), candidates_.end(),
                       [&](const WindowModel& c) { return c.credible && images_of(c) >= enough; });
  }

  // Chooses the candidate with the smallest error among the credible ones that have about the most images; where a
  // witness is needed, what most images of two candidates agree on.
  void choose() {
    if (in_.by_place || (in_.needs_witness() && can_have_witness())) return choose_confirmed();
    double most = 0;
    for (const WindowModel& c : candidates_)
      if (c.credible) most = std::max(most, images_of(c));
    const WindowModel* best = nullptr;
    for (const WindowModel& c : candidates_) {
      const bool has_most = images_of(c) >= kCompleteRatio * most;
      if (c.credible && has_most && (!best || c.quality.rmse_px < best->quality.rmse_px)) best = &c;
    }
    if (best)
      result.best = *best;
    else if (!candidates_.empty())
      result.best = Error{fmt::format("no credible model in {} attempts: {}", result.attempts, doubts())};
    else if (!result.warning.empty())
      result.best = Error{result.warning};
  }

  WindowModelResult result;

 private:
  // Counts images that were broken off too: a candidate that keeps them connected has only guessed their scale.
  static double images_of(const WindowModel& c) {
    return static_cast<double>(c.model.cam_from_world.size()) + c.broken_off;
  }

  // Without COLMAP, or without a global model, all models are begun in one way.
  bool can_have_witness() const {
    return std::any_of(candidates_.begin(), candidates_.end(),
                       [this](const WindowModel& c) { return c.begun != candidates_.front().begun; });
  }

  struct Confirmed {
    const WindowModel* model = nullptr;
    std::set<int> images;
  };

  // Returns the candidate of which most images are placed alike by candidates that were begun in other ways, with these
  // images. What was begun with the map's poses is a witness only: it has the map's own errors, which are to be mended.
  Confirmed most_confirmed() const {
    Confirmed most;
    for (const WindowModel& c : candidates_) {
      if (!c.credible || c.begun == WindowModel::Beginning::kMap) continue;
      std::set<int> images;
      for (const WindowModel& other : candidates_)
        if (other.begun != c.begun) images.merge(agreeing_images(other.model, c.model));
      if (images.size() > most.images.size()) most = {&c, std::move(images)};
    }
    return most;
  }

  void choose_confirmed() {
    const Confirmed most = most_confirmed();
    if (!most.model) {
      result.best =
          candidates_.size() == 1
              ? Error{fmt::format("the only model, {}, has no witness", candidates_.front().origin)}
              : Error{fmt::format("no two of {} models agree on where most of their images are", candidates_.size())};
      return;
    }
    WindowModel best = completion_.reduced(*most.model, most.images);
    judge_model(in_, rotations_, o_, &best);
    if (best.credible)
      result.best = std::move(best);
    else
      result.best = best.credible.error();
  }

  MapperSettings common_settings() const {
    MapperSettings settings;
    settings.min_model_size = std::max(3, connected_ / 4);
    settings.min_num_matches = kMinInliers;
    settings.abs_pose_min_num_inliers = o_.refinement.resection_min_inliers;
    return settings;
  }

  MapperOutcome run_mapper(const std::string& seed, const MapperSettings& settings) {
    MapperCommand command;
    command.database = folder_ + "/database.db";
    command.output_folder = fmt::format("{}/models-{}", folder_, ++result.attempts);
    command.input_model = seed;
    command.log_file = folder_ + "/colmap.log";
    command.keypoint_counts = keypoint_counts_;
    command.cpu_limit_s = o_.mapper_cpu_limit_s;
    command.time_limit_s = kWallPerCpuTime * o_.mapper_cpu_limit_s;
    command.nice = o_.nice;
    MapperOutcome outcome = mapper_.run(command, settings, cancel_);
    result.child_cpu_s += outcome.cpu_s;
    add_stage_cpu("ruminator.colmap", outcome.cpu_s);
    if (!outcome.models) result.warning = outcome.models.error_text();
    result.retryable = result.retryable || outcome.retryable();
    return outcome;
  }

  // Lets COLMAP add images to our model. Adds a candidate if it did.
  void extend(const std::string& seed, WindowModel* ours) {
    MapperSettings settings = common_settings();
    settings.min_model_size = 3;
    MapperOutcome outcome = run_mapper(seed, settings);
    if (!outcome.models) return;
    // COLMAP begins another model if ours cannot be extended; so take the largest.
    SparseModel& extended = *std::max_element(
        outcome.models->begin(), outcome.models->end(),
        [](const SparseModel& a, const SparseModel& b) { return a.cam_from_world.size() < b.cam_from_world.size(); });
    if (extended.cam_from_world.size() <= ours->model.cam_from_world.size()) return;
    add_global(completion_.complete(std::move(extended), "global model extended by COLMAP"));
  }

  void add_global(WindowModel candidate) {
    candidate.begun = WindowModel::Beginning::kGlobal;
    judge_model(in_, rotations_, o_, &candidate);
    keep(std::move(candidate));
  }

  // Adds a candidate that COLMAP began with one pair, which may be a wrong one. So it must not contradict a credible
  // global model, but it may have more images. Where a witness is needed, most_confirmed() compares the models image
  // by image.
  void add_rival(WindowModel candidate) {
    judge_model(in_, rotations_, o_, &candidate);
    for (const WindowModel& global : candidates_)
      if (!in_.needs_witness() && candidate.credible && global.begun == WindowModel::Beginning::kGlobal &&
          global.credible)
        candidate.credible = compare_shapes(global.model, candidate.model, in_.utimes_us, o_);
    keep(std::move(candidate));
  }

  void keep(WindowModel candidate) {
    log_debug("{}: {} of {} images, {} left out, {:.2f} px, pair rotations {:.1f} degrees off{}{}", candidate.origin,
              candidate.model.cam_from_world.size(), in_.images.size(), candidate.broken_off, candidate.quality.rmse_px,
              candidate.pair_rotation_deg, candidate.credible ? "" : "; ", candidate.credible.error_text());
    candidates_.push_back(std::move(candidate));
  }

  std::string doubts() const {
    std::string text;
    for (const WindowModel& c : candidates_)
      text += fmt::format("{}{} ({} of {} images): {}", text.empty() ? "" : "; ", c.origin,
                          c.model.cam_from_world.size(), in_.images.size(), c.credible.error_text());
    return text;
  }

  const WindowModelInput& in_;
  const BuildOptions& o_;
  std::string folder_;
  const std::atomic<bool>& cancel_;
  ColmapModels& colmap_models_;
  ColmapMapper mapper_;
  ModelCompletion completion_;
  std::vector<RelativeRotation> rotations_;
  std::vector<int> keypoint_counts_;
  int connected_ = 0;  // size of the largest group of connected images
  std::vector<WindowModel> candidates_;
};

Result<> check_quality(const WindowModel& candidate, const BuildOptions& options) {
  const size_t images = candidate.model.cam_from_world.size();
  if (images < 3) return Error{fmt::format("{} images have a pose", images)};
  if (candidate.quality.rmse_px > options.max_rmse_px)
    return Error{fmt::format("reprojection error {:.2f} px", candidate.quality.rmse_px)};
  if (candidate.pair_rotation_deg > options.max_pair_rotation_deg)
    return Error{fmt::format("its rotations differ from those between its images by {:.1f} degrees",
                             candidate.pair_rotation_deg)};
  return {};
}

}  // namespace

void judge_model(const WindowModelInput& input, const std::vector<RelativeRotation>& rotations,
                 const BuildOptions& options, WindowModel* candidate) {
  std::map<int64_t, SE3> poses;
  for (const auto& [image, pose] : candidate->model.cam_from_world) poses[input.utimes_us[image]] = pose;
  candidate->agreement = compare_with_front(input.front, poses);
  candidate->pair_rotation_deg = median_rotation_error_deg(rotations, candidate->model);
  candidate->credible = check_quality(*candidate, options);
}

Result<> compare_shapes(const SparseModel& global, const SparseModel& rival, const std::vector<int64_t>& utimes_us,
                        const BuildOptions& options) {
  constexpr int32_t kGlobal = 1;
  std::vector<Sample> samples;
  for (const auto& [image, pose] : global.cam_from_world) samples.push_back({utimes_us[image], false, kGlobal, pose});
  std::map<int64_t, SE3> poses;
  for (const auto& [image, pose] : rival.cam_from_world) poses[utimes_us[image]] = pose;
  const std::vector<FrontAgreement> shape = compare_with_front(samples, poses);
  if (shape.empty() || shape[0].position_ratio <= options.max_rival_position_ratio) return {};
  return Error{fmt::format("its positions differ from those of the global model by {:.2f} of their spread",
                           shape[0].position_ratio)};
}

namespace {

WindowModelResult attempt(const WindowModelInput& input, const BuildOptions& options, const std::string& folder,
                          const std::function<void(double)>& progress, const std::atomic<bool>& cancel,
                          ColmapModels* colmap_models) {
  Attempts attempts(input, options, folder, cancel, colmap_models);
  const std::string database = folder + "/database.db";
  if (const Result<> written = write_colmap_database(database, input.camera, input.images, input.pairs); !written) {
    attempts.result.best = written.error();
    attempts.result.retryable = true;
    return attempts.result;
  }
  if (input.by_place) attempts.map();
  attempts.global();
  progress(0.5);
  std::array angles_deg = {4.0, 8.0, 16.0};
  // The widest first pair has most often the most images. But where all is near in time there may be none.
  if (input.by_place) std::reverse(angles_deg.begin(), angles_deg.end());
  for (size_t i = 0; i < angles_deg.size() && !attempts.is_enough() && !cancel; ++i) {
    attempts.colmap_alone(angles_deg[i]);
    progress(0.6 + 0.1 * static_cast<double>(i + 1));
  }
  if (cancel) {
    attempts.result.cancelled = true;
    attempts.result.best = Error{"cancelled"};
    return attempts.result;
  }
  attempts.choose();
  return attempts.result;
}

// True if images were broken off the model, and what is left has too few images of any front submap to compare it,
// though a front submap has enough poses in the window.
bool is_adrift(const WindowModelInput& input, const WindowModelResult& result) {
  if (input.by_place || !result.best || result.best->broken_off == 0 || !result.best->agreement.empty()) return false;
  std::map<int32_t, size_t> known;
  for (const Sample& sample : input.front) ++known[sample.submap_id];
  return std::any_of(known.begin(), known.end(), [](const auto& submap) { return submap.second >= kMinFrontFrames; });
}

}  // namespace

WindowModelResult build_window_model(const WindowModelInput& input, const BuildOptions& options,
                                     const std::string& work_folder, const std::function<void(double)>& progress,
                                     const std::atomic<bool>& cancel) {
  const StageClock clock("ruminator.model");
  ColmapModels colmap_models;
  WindowModelResult first = attempt(input, options, work_folder, progress, cancel, &colmap_models);
  if (!is_adrift(input, first)) return first;
  // Between sharp and blurred images, noise severs more matches than among sharp or among blurred ones. With a wider
  // limit a real tear may be missed, but a model of the blurred images alone would be useless.
  BuildOptions lenient = options;
  lenient.tear_max_severed = std::max(options.tear_max_severed, kMaxSeveredAdrift);
  const std::string folder = work_folder + "/lenient";
  std::error_code ignored;  // if it fails, write_colmap_database() reports why
  fs::create_directories(folder, ignored);
  WindowModelResult second = attempt(
      input, lenient, folder, [](double) {}, cancel, &colmap_models);
  const bool has_agreement = second.best && !second.best->agreement.empty();
  WindowModelResult& better = second.cancelled || has_agreement ? second : first;
  const int attempts = first.attempts + second.attempts;
  const double child_cpu_s = first.child_cpu_s + second.child_cpu_s;
  better.attempts = attempts;
  better.child_cpu_s = child_cpu_s;
  return better;
}

}  // namespace rumi::ruminator
