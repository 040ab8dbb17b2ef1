// SPDX-License-Identifier: BSD-3-Clause
// Advice for a recording of messages that has several channels with images.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace rumi {

// "CAMERA_LEFT (12), CAMERA_RIGHT (12)", the first ones.
std::string list_of_channels(const std::vector<std::pair<std::string, int64_t>>& messages_on);
// "it has images on ...: name one with ..."; `best` for an example.
std::string advice_on_channels(const std::vector<std::pair<std::string, int64_t>>& images_on, const std::string& best);

}  // namespace rumi
