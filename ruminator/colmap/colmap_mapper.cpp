// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/colmap/colmap_mapper.h"

#include <fmt/format.h>
#include <signal.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "base/files/free_space.h"
#include "ruminator/colmap/colmap_dialect.h"
#include "ruminator/colmap/colmap_environment.h"

namespace rumi::ruminator {
namespace {

namespace fs = std::filesystem;

using Kind = MapperOutcome::Kind;
using Outcome = ChildResult::Outcome;

constexpr uintmax_t kFullDiskBytes = 1 << 20;  // with less free space, the full disk is taken for the cause
constexpr double kIdleLimitS = 300;            // a mapper that uses no CPU and prints nothing for this long hangs
constexpr size_t kLongestLine = 4096;

// Reports the number of registered images, which it reads from the mapper's output line by line.
class ProgressReader {
 public:
  explicit ProgressReader(const std::function<void(int)>& progress) : progress_(progress) {}
  void take(std::string_view text) {
    for (const char c : text) {
      if (c != '\n') {
        if (line_.size() < kLongestLine) line_ += c;
        continue;
      }
      if (const std::optional<int> images = registered_images(line_)) progress_(*images);
      line_.clear();
    }
  }

 private:
  const std::function<void(int)>& progress_;
  std::string line_;
};

bool tells_of_full_disk(std::string_view text) {
  return contains_any_case(text, "no space left") || contains_any_case(text, "disk is full") ||
         contains_any_case(text, "disk quota exceeded");
}

// COLMAP does not check its writes: on a full disk it ends without an error and leaves truncated files.
bool is_full(const std::string& folder) { return free_space(folder).value_or(kFullDiskBytes) < kFullDiskBytes; }

bool is_from_outside(int signal) {
  return signal == SIGKILL || signal == SIGTERM || signal == SIGINT || signal == SIGHUP || signal == SIGQUIT;
}

Result<> make_folder(const std::string& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return Error{error.message(), folder};
  const bool empty = fs::is_empty(folder, error);
  if (error) return Error{error.message(), folder};
  if (!empty) return Error{"is not empty", folder, "a run of the mapper needs a folder of its own"};
  return {};
}

void fail(MapperOutcome* outcome, Kind kind, const std::string& why) {
  outcome->kind = kind;
  outcome->models = Error{why};
}

// Sets the kind and the reason of the failure of a COLMAP process.
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
  if (child.outcome == Outcome::kExited && tells_of_no_model(child.last_output))
    return fail(outcome, Kind::kNoModel, "COLMAP found no model: no pair of images to begin with, or too few to go on");
  fail(outcome, Kind::kFailed, details);
}

std::vector<std::string> folders_of_models(const MapperCommand& command) {
  std::vector<std::string> folders = colmap_model_folders(command.output_folder);
  std::error_code ignored;
  // An extended model is written to the output folder itself, not to a numbered one.
  if (folders.empty() && fs::exists(command.output_folder + "/images.bin", ignored))
    folders.push_back(command.output_folder);
  return folders;
}

void read_models(const MapperCommand& command, MapperOutcome* outcome) {
  std::vector<SparseModel> models;
  for (const std::string& folder : folders_of_models(command)) {
    Result<SparseModel> model = read_colmap_model(folder, command.keypoint_counts);
    if (!model) {
      const std::string problem = model.error_text();
      if (is_full(command.output_folder)) return fail(outcome, Kind::kDiskFull, problem + "; the disk is full");
      return fail(outcome, Kind::kCorrupt, fmt::format("COLMAP left a model that cannot be read: {}", problem));
    }
    models.push_back(std::move(*model));
  }
  if (models.empty()) return fail(outcome, Kind::kNoModel, "COLMAP ended well, but left no model");
  outcome->kind = Kind::kModels;
  outcome->models = std::move(models);
}

void add_cost(const ChildResult& child, MapperOutcome* outcome) {
  outcome->wall_s += child.wall_s;
  outcome->cpu_s += child.cpu_s;
}

}  // namespace

// Gives up COLMAP if the machine is the cause of the failure: every other window would fail too, after a long wait.
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
  if (const Result<> made = make_folder(command.output_folder); !made) {
    const std::string problem = made.error_text();
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
  child.arguments = mapper_arguments(command, settings, program_->options());
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
