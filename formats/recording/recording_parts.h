// SPDX-License-Identifier: BSD-3-Clause
// Recordings that their recorder split into files: walk_0.bag and walk_1.bag, walk.lcm.00 and walk.lcm.01.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace rumi {

// The first and the last time of a part, by the recorder's clock.
struct PartTimes {
  std::string name;
  int64_t first_us = 0, last_us = 0;
};

// The files of a folder that may be parts of one recording, by their numbers: its recordings are lcm logs or bags, and
// their names differ in numbers only. Empty if there are not two, and where the folder has images or a list of them.
std::vector<std::filesystem::path> parts_in(const std::filesystem::path& folder);
// Names the part that does not begin where the one before ends, and what to do: these parts are separate recordings.
// Empty if the parts are one recording.
std::string why_not_one_recording(const std::vector<PartTimes>& parts);
// When the first message of a file was recorded; nothing if there is none.
using FirstRecorded = std::function<std::optional<int64_t>(const std::filesystem::path&)>;
std::optional<int64_t> first_recorded_in_log(const std::filesystem::path& file);
// "walk_1.db3 beside it goes on where it ends ...": of a file of a recording that ends at last_us. Empty if none does.
std::string note_on_next_part(const std::filesystem::path& file, int64_t last_us,
                              const FirstRecorded& first_recorded_us);

// As above for a video, whose times do not tell: notes that another one beside it has the next number, and how to join
// the two.
std::string note_on_next_video(const std::filesystem::path& file);

}  // namespace rumi
