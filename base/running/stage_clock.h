// SPDX-License-Identifier: BSD-3-Clause
// The CPU time of the process by stage, so that a user sees which stages are expensive.
#pragma once

#include <map>
#include <string>

namespace rumi {

// Measures the CPU time of its thread while it exists. The time of a stage within another counts only for the inner
// one.
class StageClock {
 public:
  explicit StageClock(const char* stage);  // "component.stage", a string literal
  ~StageClock();
  StageClock(const StageClock&) = delete;
  StageClock& operator=(const StageClock&) = delete;

 private:
  const char* stage_;
  StageClock* outer_;
  double begin_s_;
};

// Adds CPU time that was measured elsewhere, such as that of a child process.
void add_stage_cpu(const char* stage, double cpu_s);

// Returns the CPU seconds that each stage of the component has used so far, in all threads, by the stage's name.
std::map<std::string, double> stage_cpu_s(const std::string& component);

}  // namespace rumi
