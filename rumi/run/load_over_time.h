// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "rumi/run/process_load.h"

namespace rumi::tool {

// CPU time and memory of a replay along its recording.
class LoadOverTime {
 public:
  // `cpu_s`: by component, since the beginning. Notes one in kEvery_s seconds of the recording.
  void note(int64_t utime_us, const std::map<std::string, double>& cpu_s);

  // Returns {"s": [...], "memory_mb": [...], "cpu_s": {component: [...]}}, one number for each note.
  nlohmann::ordered_json to_json() const;

  static constexpr double kEvery_s = 5;

 private:
  int64_t first_us_ = 0;
  std::vector<double> s_, memory_mb_;
  std::map<std::string, std::vector<double>> cpu_s_;
};

// Reads what to_json() gave: CPU in percent of a core at the recording's own pace. Empty if the JSON is none.
ProcessLoad load_from_json(const nlohmann::ordered_json& json);

}  // namespace rumi::tool
