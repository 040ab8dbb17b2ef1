// SPDX-License-Identifier: BSD-3-Clause
// The processes that `rumi up` starts: their command lines, and the file of options that they share.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "rumi/commands/up_arguments.h"
#include "rumi/run/supervisor.h"

namespace rumi::tool {

// A file with the options of all processes, which lives as long as this object.
class SharedConfig {
 public:
  // Makes the file. Throws std::runtime_error if it cannot be written.
  explicit SharedConfig(const std::string& yaml);
  ~SharedConfig();
  SharedConfig(const SharedConfig&) = delete;
  SharedConfig& operator=(const SharedConfig&) = delete;
  // Replaces the content of the file. Throws std::runtime_error if it cannot be written.
  void write(const std::string& yaml) const;
  const std::string& file() const { return file_; }

 private:
  std::string file_;
};

// Returns the processes in the order of their start. map_server is stopped after the others, so that it receives what
// they send at their end.
std::vector<Supervised> processes(const UpOptions& up, const std::string& config_file, const UpArguments& arguments);

// Returns the process that takes a snapshot. If `is_last`, it prints a summary, keeps the status of processes that have
// ended since the first snapshot (--update), and takes the landmarks' colours from the recording if that is played once
// and with its own times.
Supervised snapshot_process(const AllOptions& options, const std::string& config_file, const std::string& out,
                            int64_t since_us, bool is_last);

}  // namespace rumi::tool
