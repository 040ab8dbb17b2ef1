// SPDX-License-Identifier: BSD-3-Clause
// Runs `colmap mapper` once on a database. The outcome has the models, or the reason why there are none.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "base/child/run_child.h"
#include "base/result.h"
#include "ruminator/colmap/colmap_program.h"
#include "ruminator/colmap/mapper_command.h"
#include "ruminator/colmap/read_model.h"

namespace rumi::ruminator {

struct MapperOutcome {
  enum class Kind {
    kModels,   // at least one model
    kNoModel,  // COLMAP found no model
    kCorrupt,  // COLMAP left a model that cannot be read
    kFailed,   // COLMAP ended with another error or crashed
    kTimedOut,
    kCancelled,
    kNotStarted,  // COLMAP is missing, its folder cannot be made, ...
    kKilled,  // by a signal from outside: SIGKILL (also sent when memory runs out), SIGTERM, SIGINT, SIGHUP, SIGQUIT
    kDiskFull,
  };
  Kind kind = Kind::kNotStarted;
  // The models, at least one, in COLMAP's order; the first is not always the best. The Error is a sentence for users.
  Result<std::vector<SparseModel>> models = Error{"COLMAP was not run"};
  double wall_s = 0, cpu_s = 0;
  // True if the circumstances are to blame and not the images: the same command may succeed later.
  bool retryable() const {
    return kind == Kind::kCancelled || kind == Kind::kNotStarted || kind == Kind::kKilled || kind == Kind::kDiskFull;
  }
};

class ColmapMapper {
 public:
  explicit ColmapMapper(std::shared_ptr<ColmapProgram> program) : program_(std::move(program)) {}
  // Uses a ColmapProgram of its own, which it shares with no other mapper.
  explicit ColmapMapper(const std::string& program) : program_(std::make_shared<ColmapProgram>(program)) {}

  MapperOutcome run(const MapperCommand& command, const MapperSettings& settings, const std::atomic<bool>& cancel);
  std::string version() const { return program_->version(); }

 private:
  void give_up_if_in_vain(const ChildResult& result, const MapperOutcome& outcome);

  std::shared_ptr<ColmapProgram> program_;
};

}  // namespace rumi::ruminator
