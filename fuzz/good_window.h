// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fuzz/target.h"
#include "ruminator/window/window_job.h"

namespace rumi::fuzz {

// Returns a file for read_window_job(): a window with `frames` images in each of its three parts.
Bytes good_window_file(int frames);

}  // namespace rumi::fuzz
