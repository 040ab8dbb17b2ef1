// SPDX-License-Identifier: BSD-3-Clause
// The command with which the tests run COLMAP, or a fake.
#pragma once

#include <atomic>
#include <string>

#include "ruminator/colmap/colmap_mapper.h"
#include "tests/support/temporary_folder.h"

namespace rumi::testing {
using namespace rumi::ruminator;

inline const std::atomic<bool> kNever = false;

inline MapperCommand command_for(const TemporaryFolder& folder, const std::string& output) {
  MapperCommand command;
  command.database = folder / "database.db";
  command.output_folder = folder / output;
  command.log_file = folder / "log";
  command.time_limit_s = 600;
  return command;
}

}  // namespace rumi::testing
