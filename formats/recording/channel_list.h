// SPDX-License-Identifier: BSD-3-Clause
// Gives advice on a recording of messages that has several channels with images.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace rumi {

// Returns the first channels with the number of messages on each: "CAMERA_LEFT (12), CAMERA_RIGHT (12)".
std::string list_of_channels(const std::vector<std::pair<std::string, int64_t>>& messages_on);
// Returns "it has images on ...: name one with ...", with `best` as the example.
std::string advice_on_channels(const std::vector<std::pair<std::string, int64_t>>& images_on, const std::string& best);

}  // namespace rumi
