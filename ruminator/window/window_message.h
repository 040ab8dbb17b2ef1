// SPDX-License-Identifier: BSD-3-Clause
// Converts a window to the message on RUMI_WINDOW and to text.
#pragma once

#include <string>

#include "lcmtypes/rumi/window_t.hpp"
#include "ruminator/window/rumination_window.h"

namespace rumi::ruminator {

// `utime_us`: time of the announcement.
window_t to_message(const RuminationWindow& window, int64_t utime_us, int8_t state);

// Returns a text for users: "10 + 45 of 60 + 12 frames between submap 1 and submap 2 (9 + 8 keyframes)".
std::string describe(const RuminationWindow& window);

}  // namespace rumi::ruminator
