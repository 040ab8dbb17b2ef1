// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/colmap/colmap_mapper.h"

#include <fmt/format.h>
#include <signal.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include "base/free_space.h"
#include "ruminator/colmap/colmap_environment.h"

namespace rumi::ruminator {
namespace {

namespace fs = std::filesystem;

using Kind = MapperOutcome::Kind;
using Outcome = ChildResult::Outcome;

constexpr uintmax_t kFullDiskBytes = 1 << 20;  // less is left: what failed, failed because of that
constexpr double kIdleLimitS = 300;            // of a mapper that neither works nor says anything: it hangs
constexpr size_t kLongestLine = 4096;
// The names that an option has had, from 3.8 on.
struct MapperOption {
  std::vector<std::string> names;
  std::string value;
};

std::vector<MapperOption> mapper_options(const MapperCommand& command, const MapperSettings& s) {
  const auto text = [](auto value) { return fmt::format("{}", value); };
  const auto flag = [](bool value) { return std::string(value ? "1" : "0"); };
  std::vector<MapperOption> options = {
      {{"database_path"}, command.database},
      {{"image_path"}, command.output_folder},  // has to exist; images are only read for colours
      {{"output_path"}, command.output_folder},
      {{"log_target"}, "stderr"},  // 4.x also writes files into /tmp
      {{"random_seed", "default_random_seed"}, text(s.random_seed)},
      {{"Mapper.random_seed"}, text(s.random_seed)},
      {{"Mapper.num_threads"}, text(s.threads)},
      {{"Mapper.extract_colors"}, flag(false)},
      {{"Mapper.min_num_matches"}, text(s.min_num_matches)},
      {{"Mapper.multiple_models"}, flag(s.multiple_models)},
      {{"Mapper.max_num_models"}, text(s.max_num_models)},
      {{"Mapper.min_model_size"}, text(s.min_model_size)},
      {{"Mapper.init_min_tri_angle"}, text(s.init_min_tri_angle_deg)},
      {{"Mapper.init_min_num_inliers"}, text(s.init_min_num_inliers)},
      {{"Mapper.abs_pose_min_num_inliers"}, text(s.abs_pose_min_num_inliers)},
      {{"Mapper.filter_max_reproj_error"}, text(s.filter_max_reproj_error_px)},
      {{"Mapper.ba_refine_focal_length"}, flag(false)},
      {{"Mapper.ba_refine_principal_point"}, flag(false)},
      {{"Mapper.ba_refine_extra_params"}, flag(false)},  // the camera has none
      {{"Mapper.ba_local_num_images"}, text(s.local_num_images)},
      {{"Mapper.ba_local_max_num_iterations"}, text(s.local_max_num_iterations)},
      {{"Mapper.ba_local_max_refinements"}, text(s.local_max_refinements)},
      {{"Mapper.ba_local_function_tolerance"}, text(s.function_tolerance)},
      {{"Mapper.ba_global_max_num_iterations"}, text(s.global_max_num_iterations)},
      {{"Mapper.ba_global_max_refinements"}, text(s.global_max_refinements)},
      {{"Mapper.ba_global_images_ratio", "Mapper.ba_global_frames_ratio"}, text(s.global_growth)},
      {{"Mapper.ba_global_points_ratio"}, text(s.global_growth)},
      {{"Mapper.ba_global_function_tolerance"}, text(s.function_tolerance)},
  };
  if (!command.input_model.empty()) {
    options.push_back({{"input_path"}, command.input_model});
    options.push_back(
        {{"Mapper.fix_existing_images", "Mapper.fix_existing_frames"}, flag(command.fix_existing_images)});
  }
  return options;
}

// What this COLMAP has no name for is left out: it would refuse to start.
std::vector<std::string> mapper_arguments(const std::vector<MapperOption>& options,
                                          const std::set<std::string>& known) {
  std::vector<std::string> arguments = {"mapper"};
  for (const MapperOption& option : options)
    for (const std::string& name : option.names)
      if (known.contains(name)) {
        arguments.push_back("--" + name);
        arguments.push_back(option.value);
        break;
      }
  return arguments;
}

// Counts the images in what the mapper says: "Registering image #7 (12)", in 4.x "(num_reg_frames=12)", before it tries
// the twelfth.
class ProgressReader {
 public:
  explicit ProgressReader(const std::function<void(int)>& progress) : progress_(progress) {}
  void take(std::string_view text) {
    for (const char c : text) {
      if (c != '\n') {
        if (line_.size() < kLongestLine) line_ += c;
        continue;
      }
      read_line();
      line_.clear();
    }
  }

 private:
  void read_line() const {
    const size_t at = line_.find("Registering image #");
    const size_t bracket = line_.find('(', at == std::string::npos ? line_.size() : at);
    const size_t digits = line_.find_first_of("0123456789", std::min(bracket, line_.size()));
    if (digits == std::string::npos) return;
    int number = 0;
    const auto read = std::from_chars(line_.data() + digits, line_.data() + line_.size(), number);
    if (read.ec == std::errc() && number > 0) progress_(number - 1);
  }

  const std::function<void(int)>& progress_;
  std::string line_;
};

bool tells_of_full_disk(std::string_view text) {
  return contains_any_case(text, "no space left") || contains_any_case(text, "disk is full") ||
         contains_any_case(text, "disk quota exceeded");
}

// COLMAP does not look whether what it writes arrives: on a full disk it ends well and leaves files cut short.
bool is_full(const std::string& folder) { return free_space(folder).value_or(kFullDiskBytes) < kFullDiskBytes; }

bool is_from_outside(int signal) {
  return signal == SIGKILL || signal == SIGTERM || signal == SIGINT || signal == SIGHUP || signal == SIGQUIT;
}

// What went wrong, or an empty string.
std::string make_folder(const std::string& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return fmt::format("{}: {}", folder, error.message());
  const bool empty = fs::is_empty(folder, error);
  if (error) return fmt::format("{}: {}", folder, error.message());
  return empty ? std::string() : fmt::format("{}: is not empty; a run of the mapper needs a folder of its own", folder);
}

void fail(MapperOutcome* outcome, Kind kind, const std::string& why) {
  outcome->kind = kind;
  outcome->failure = why;
  outcome->models.clear();
  outcome->folders.clear();
}

// A child that did not end well.
void judge_failure(const ChildResult& child, const MapperCommand& command, MapperOutcome* outcome) {
  const std::string said = complaint(child.last_output);
  const std::string described = fmt::format("COLMAP's mapper: {}", child.describe());
  const std::string details = said.empty() ? described : fmt::format("{}: {}", described, said);
  if (child.outcome == Outcome::kCancelled) return fail(outcome, Kind::kCancelled, "cancelled");
  if (child.outcome == Outcome::kTimedOut) return fail(outcome, Kind::kTimedOut, described);
  if (child.outcome == Outcome::kNotStarted) {
    const Kind kind = tells_of_full_disk(child.error) ? Kind::kDiskFull : Kind::kNotStarted;
    return fail(outcome, kind, child.error);
  }
  if (child.outcome == Outcome::kSignalled && is_from_outside(child.signal))
    return fail(outcome, Kind::kKilled, described);
  if (tells_of_full_disk(child.last_output) || is_full(command.output_folder))
    return fail(outcome, Kind::kDiskFull, fmt::format("{}: the disk is full; {}", command.output_folder, details));
  if (child.outcome == Outcome::kExited && contains_any_case(child.last_output, "failed to create sparse model"))
    return fail(outcome, Kind::kNoModel, "COLMAP found no model: no pair of images to begin with, or too few to go on");
  fail(outcome, Kind::kFailed, details);
}

std::vector<std::string> folders_of_models(const MapperCommand& command) {
  std::vector<std::string> folders = colmap_model_folders(command.output_folder);
  std::error_code ignored;
  // A model that is extended is not numbered.
  if (folders.empty() && fs::exists(command.output_folder + "/images.bin", ignored))
    folders.push_back(command.output_folder);
  return folders;
}

void read_models(const MapperCommand& command, MapperOutcome* outcome) {
  for (const std::string& folder : folders_of_models(command)) {
    SparseModelFile file = read_colmap_model(folder, command.keypoint_counts);
    if (!file.ok()) {
      if (is_full(command.output_folder))
        return fail(outcome, Kind::kDiskFull, fmt::format("{}; the disk is full", file.error));
      return fail(outcome, Kind::kCorrupt, fmt::format("COLMAP left a model that cannot be read: {}", file.error));
    }
    outcome->models.push_back(std::move(file.model));
    outcome->folders.push_back(folder);
  }
  if (outcome->models.empty()) return fail(outcome, Kind::kNoModel, "COLMAP ended well, but left no model");
  outcome->kind = Kind::kModels;
}

void add_cost(const ChildResult& child, MapperOutcome* outcome) {
  outcome->wall_s += child.wall_s;
  outcome->cpu_s += child.cpu_s;
}

}  // namespace

// What fails because of the machine fails with every window, and may take long to.
void ColmapMapper::give_up_if_in_vain(const ChildResult& result, const MapperOutcome& outcome) {
  if (outcome.kind == Kind::kFailed && tells_of_gpu(result.last_output))
    program_->give_up(fmt::format("{} needs a GPU that it cannot use here ({}); a build of it without CUDA works",
                                  program_->name(), complaint(result.last_output)));
  if (outcome.kind == Kind::kTimedOut && result.was_idle)
    program_->give_up(fmt::format("{} hangs ({})", program_->name(), result.describe()));
}

MapperOutcome ColmapMapper::run(const MapperCommand& command, const MapperSettings& settings,
                                const std::atomic<bool>& cancel) {
  MapperOutcome outcome;
  if (const std::string problem = make_folder(command.output_folder); !problem.empty()) {
    fail(&outcome, tells_of_full_disk(problem) ? Kind::kDiskFull : Kind::kNotStarted, problem);
    return outcome;
  }
  if (program_->is_given_up()) {
    fail(&outcome, Kind::kFailed, "COLMAP was not used, as it did not work before");
    return outcome;
  }
  const ChildResult help = program_->ask(command.nice, cancel);
  add_cost(help, &outcome);
  if (!help.ok()) {
    judge_failure(help, command, &outcome);
    return outcome;
  }
  ProgressReader progress(command.progress);
  ChildCommand child;
  child.arguments = mapper_arguments(mapper_options(command, settings), program_->options());
  child.arguments.insert(child.arguments.begin(), program_->name());
  child.environment = colmap_environment();
  child.log_file = command.log_file;
  if (command.progress) child.on_output = [&](std::string_view text) { progress.take(text); };
  child.cpu_limit_s = command.cpu_limit_s;
  child.time_limit_s = command.time_limit_s;
  child.idle_limit_s = kIdleLimitS;
  child.nice = command.nice;
  child.threads = settings.threads;
  const ChildResult result = run_child(child, cancel);
  add_cost(result, &outcome);
  if (result.ok()) {
    read_models(command, &outcome);
    return outcome;
  }
  judge_failure(result, command, &outcome);
  give_up_if_in_vain(result, outcome);
  return outcome;
}

}  // namespace rumi::ruminator
