// SPDX-License-Identifier: BSD-3-Clause
// CPU time of the process by stage, so that a user sees what costs.
#pragma once

#include <map>
#include <string>

namespace rumi {

// Measures its thread while it lives. A stage within another counts for itself alone.
class StageClock {
 public:
  explicit StageClock(const char* stage);  // "component.stage", a literal
  ~StageClock();
  StageClock(const StageClock&) = delete;
  StageClock& operator=(const StageClock&) = delete;

 private:
  const char* stage_;
  StageClock* outer_;
  double begin_s_;
};

// Adds CPU time that was measured otherwise, such as that of a child process.
void add_stage_cpu(const char* stage, double cpu_s);

// CPU seconds so far of the stages of a component, by "stage"; of all threads.
std::map<std::string, double> stage_cpu_s(const std::string& component);

}  // namespace rumi
