// SPDX-License-Identifier: BSD-3-Clause
// Finds recordings that their recorder split into files: walk_0.bag and walk_1.bag, walk.lcm.00 and walk.lcm.01.
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

// Lists the files of a folder that may be parts of one recording, by their numbers: its recordings are lcm logs or
// bags, and their names differ only in numbers. Empty if there are fewer than two, and if the folder has images or a
// list of images.
std::vector<std::filesystem::path> parts_in(const std::filesystem::path& folder);
// Names the part that does not begin where the one before ends, and what to do: these parts are separate recordings.
// Empty if the parts are one recording.
std::string why_not_one_recording(const std::vector<PartTimes>& parts);
// Returns the time at which the first message of a file was recorded; nullopt if it has none.
using FirstRecorded = std::function<std::optional<int64_t>(const std::filesystem::path&)>;
std::optional<int64_t> first_recorded_in_log(const std::filesystem::path& file);
// Returns a note if a file beside this part, which ends at last_us, goes on there: "walk_1.db3 beside it goes on where
// it ends ..."; else empty.
std::string note_on_next_part(const std::filesystem::path& file, int64_t last_us,
                              const FirstRecorded& first_recorded_us);

// Returns a note, with how to join the two, if a video beside this one has the next number; else empty. (Times of
// videos do not tell whether one goes on where the other ends.)
std::string note_on_next_video(const std::filesystem::path& file);

}  // namespace rumi
