// SPDX-License-Identifier: BSD-3-Clause
// One run of `colmap mapper`: from a database to the models that it leaves, or the reason why there are none.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "base/child/run_child.h"
#include "base/this_process/process_name.h"
#include "ruminator/colmap/colmap_program.h"
#include "ruminator/colmap/mapper_command.h"
#include "ruminator/colmap/read_model.h"

namespace rumi::ruminator {

struct MapperOutcome {
  enum class Kind {
    kModels,   // there is at least one
    kNoModel,  // COLMAP found none
    kCorrupt,  // it left something that cannot be read
    kFailed,   // it ended with another error or crashed
    kTimedOut,
    kCancelled,
    kNotStarted,  // no COLMAP, no folder to write to, ...
    kKilled,      // from outside: SIGKILL (out of memory, too), SIGTERM, SIGINT, SIGHUP
    kDiskFull,
  };
  Kind kind = Kind::kNotStarted;
  std::vector<SparseModel> models;   // as COLMAP numbers them; the first is not always the best
  std::vector<std::string> folders;  // of each model
  std::string failure;               // a sentence for a person; empty with models
  double wall_s = 0, cpu_s = 0;
  // The machine failed, not the images: the same command may succeed later.
  bool retryable() const {
    return kind == Kind::kCancelled || kind == Kind::kNotStarted || kind == Kind::kKilled || kind == Kind::kDiskFull;
  }
};

class ColmapMapper {
 public:
  explicit ColmapMapper(std::shared_ptr<ColmapProgram> program) : program_(std::move(program)) {}
  // One that no other mapper knows.
  explicit ColmapMapper(const std::string& program) : program_(std::make_shared<ColmapProgram>(program)) {}

  MapperOutcome run(const MapperCommand& command, const MapperSettings& settings, const std::atomic<bool>& cancel);
  std::string version() const { return program_->version(); }

 private:
  void give_up_if_in_vain(const ChildResult& result, const MapperOutcome& outcome);

  std::shared_ptr<ColmapProgram> program_;
};

}  // namespace rumi::ruminator
