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
  // Throws std::runtime_error.
  explicit SharedConfig(const std::string& yaml);
  ~SharedConfig();
  SharedConfig(const SharedConfig&) = delete;
  SharedConfig& operator=(const SharedConfig&) = delete;
  // Throws std::runtime_error.
  void write(const std::string& yaml) const;
  const std::string& file() const { return file_; }

 private:
  std::string file_;
};

// map_server is stopped after the others, so that it still receives the messages that they send at their end.
std::vector<Supervised> processes(const UpOptions& up, const std::string& config_file, const UpArguments& arguments);

// `is_last`: it prints a summary, and --update keeps the status of processes that have ended since the first snapshot.
// The map gets the colours of a recording if that is played as it is.
Supervised snapshot_process(const AllOptions& options, const std::string& config_file, const std::string& out,
                            int64_t since_us, bool is_last);

}  // namespace rumi::tool
