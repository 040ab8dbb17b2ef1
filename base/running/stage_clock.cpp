// SPDX-License-Identifier: BSD-3-Clause
#include "base/running/stage_clock.h"

#include <mutex>
#include <string_view>
#include <utility>

#include "base/this_process/cpu_clock.h"

namespace rumi {
namespace {

class Sums {
 public:
  void add(std::string_view stage, double cpu_s) {
    const std::scoped_lock lock(mutex_);
    const auto at = cpu_s_.find(stage);
    if (at != cpu_s_.end())
      at->second += cpu_s;
    else
      cpu_s_.emplace(stage, cpu_s);
  }
  std::map<std::string, double> of(const std::string& component) {
    const std::scoped_lock lock(mutex_);
    std::map<std::string, double> result;
    const std::string prefix = component + '.';
    for (auto at = cpu_s_.lower_bound(prefix); at != cpu_s_.end() && at->first.starts_with(prefix); ++at)
      result[at->first.substr(prefix.size())] = at->second;
    return result;
  }

 private:
  std::mutex mutex_;
  std::map<std::string, double, std::less<>> cpu_s_;
};

Sums& sums() {
  static Sums sums;
  return sums;
}

thread_local StageClock* innermost = nullptr;

}  // namespace

StageClock::StageClock(const char* stage)
    : stage_(stage), outer_(std::exchange(innermost, this)), begin_s_(thread_cpu_s()) {
  if (outer_) sums().add(outer_->stage_, begin_s_ - outer_->begin_s_);
}

StageClock::~StageClock() {
  const double now_s = thread_cpu_s();
  sums().add(stage_, now_s - begin_s_);
  innermost = outer_;
  if (outer_) outer_->begin_s_ = now_s;
}

void add_stage_cpu(const char* stage, double cpu_s) { sums().add(stage, cpu_s); }

std::map<std::string, double> stage_cpu_s(const std::string& component) { return sums().of(component); }

}  // namespace rumi
