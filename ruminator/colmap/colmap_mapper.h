// SPDX-License-Identifier: BSD-3-Clause
// Runs `colmap mapper` once: from a database to the models that it leaves, or to the reason why there are none.
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
    kModels,   // there is at least one
    kNoModel,  // COLMAP found none
    kCorrupt,  // COLMAP left a model that cannot be read
    kFailed,   // COLMAP ended with another error or crashed
    kTimedOut,
    kCancelled,
    kNotStarted,  // no COLMAP, no folder to write to, ...
    kKilled,      // by somebody else: SIGKILL (also when memory is short), SIGTERM, SIGINT, SIGHUP
    kDiskFull,
  };
  Kind kind = Kind::kNotStarted;
  // One at least, as COLMAP numbers them; the first is not always the best. The Error is a sentence for a person.
  Result<std::vector<SparseModel>> models = Error{"COLMAP was not run"};
  double wall_s = 0, cpu_s = 0;
  // True if the machine failed, not the images: the same command may succeed later.
  bool retryable() const {
    return kind == Kind::kCancelled || kind == Kind::kNotStarted || kind == Kind::kKilled || kind == Kind::kDiskFull;
  }
};

class ColmapMapper {
 public:
  explicit ColmapMapper(std::shared_ptr<ColmapProgram> program) : program_(std::move(program)) {}
  // Uses a program of its own, which no other mapper shares.
  explicit ColmapMapper(const std::string& program) : program_(std::make_shared<ColmapProgram>(program)) {}

  MapperOutcome run(const MapperCommand& command, const MapperSettings& settings, const std::atomic<bool>& cancel);
  std::string version() const { return program_->version(); }

 private:
  void give_up_if_in_vain(const ChildResult& result, const MapperOutcome& outcome);

  std::shared_ptr<ColmapProgram> program_;
};

}  // namespace rumi::ruminator
