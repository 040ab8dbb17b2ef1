// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz/target.h"

#include <spdlog/spdlog.h>

#include <cstdio>
#include <cstdlib>

#include "base/this_process/cpu_clock.h"

namespace rumi::fuzz {
namespace {

constexpr double kLongestStep_s = 1;
bool limited = false;
double step_began_s = 0;

std::vector<Target>& registered() {
  static std::vector<Target> all;
  return all;
}

}  // namespace

const std::vector<Target>& targets() { return registered(); }

void limit_steps() {
  limited = true;
  step_began_s = thread_cpu_s();
}

void end_step() {
  const double now_s = thread_cpu_s(), took_s = now_s - step_began_s;
  step_began_s = now_s;
  if (!limited || took_s <= kLongestStep_s) return;
  std::fprintf(stderr, "ERROR: a step took %.2f s of CPU time\n", took_s);
  std::abort();
}

Registered::Registered(Target target) {
  spdlog::set_level(spdlog::level::off);  // logging each broken message would slow fuzzing down
  registered().push_back(std::move(target));
}

}  // namespace rumi::fuzz
