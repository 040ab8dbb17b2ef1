// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/run/load_over_time.h"

#include <algorithm>

#include "base/this_process/resident_bytes.h"

namespace rumi::tool {

void LoadOverTime::note(int64_t utime_us, const std::map<std::string, double>& cpu_s) {
  if (s_.empty()) first_us_ = utime_us;
  const double at_s = 1e-6 * static_cast<double>(utime_us - first_us_);
  if (!s_.empty() && at_s < s_.back() + kEvery_s) return;
  s_.push_back(at_s);
  memory_mb_.push_back(static_cast<double>(resident_bytes()) / 1e6);
  for (const auto& [component, seconds] : cpu_s) cpu_s_[component].push_back(seconds);
}

nlohmann::ordered_json LoadOverTime::to_json() const {
  return {{"s", s_}, {"memory_mb", memory_mb_}, {"cpu_s", cpu_s_}};
}

ProcessLoad load_from_json(const nlohmann::ordered_json& json) {
  ProcessLoad load;
  try {
    const auto s = json.at("s").get<std::vector<double>>();
    const auto memory_mb = json.at("memory_mb").get<std::vector<double>>();
    for (size_t i = 0; i < std::min(s.size(), memory_mb.size()); ++i)
      load.memory_mb["replay"].emplace_back(s[i], memory_mb[i]);
    for (const auto& [component, seconds] : json.at("cpu_s").get<std::map<std::string, std::vector<double>>>())
      for (size_t i = 1; i < std::min(s.size(), seconds.size()); ++i)
        if (s[i] > s[i - 1])
          load.cpu_percent[component].emplace_back(s[i], 100 * (seconds[i] - seconds[i - 1]) / (s[i] - s[i - 1]));
  } catch (const nlohmann::json::exception&) {
    return {};
  }
  return load;
}

}  // namespace rumi::tool
