// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/outputs/run_record.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>

namespace rumi::tool {

std::string note_missing(const std::vector<std::string>& missing, const std::string& folder,
                         nlohmann::ordered_json* run) {
  if (missing.empty()) return {};
  (*run)["missing"] = missing;
  return fmt::format("{}; what could be written is in {}", fmt::join(missing, "; "), folder);
}

nlohmann::ordered_json counts_to_json(const AtlasCounts& counts) {
  nlohmann::ordered_json json = {
      {"frames", counts.frames},   {"tracked_frames", counts.tracked_frames}, {"frames_in_map", counts.frames_in_map},
      {"submaps", counts.submaps}, {"keyframes", counts.keyframes},           {"landmarks", counts.landmarks}};
  if (counts.earlier_frames == 0) return json;
  json["earlier_frames"] = counts.earlier_frames;
  json["earlier_sessions"] = counts.earlier_sessions;
  json["localized_frames"] = counts.is_joined ? counts.frames_in_map : 0;
  return json;
}

void print_summary(const AtlasCounts& counts, const std::vector<std::string>& notes,
                   const std::vector<std::string>& left_out, const std::string& folder) {
  const auto file = [&](const char* name) { return (std::filesystem::path(folder) / name).string(); };
  fmt::print("{} of {} frames have a pose in the map, {} in any of {} submaps; {} keyframes, {} landmarks\n",
             counts.frames_in_map, counts.frames, counts.tracked_frames, counts.submaps, counts.keyframes,
             counts.landmarks);
  for (const std::string& note : notes) fmt::print("{}\n", note);
  for (const std::string& line : left_out) fmt::print("left out    {}\n", line);
  fmt::print("trajectory  {}\nmap         {}  and  {}\npicture     {}\n", file("trajectory.txt"), file("map.db"),
             file("map.ply"), file("trajectory.png"));
}

}  // namespace rumi::tool
