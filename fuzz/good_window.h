// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fuzz/target.h"
#include "ruminator/window/window_job.h"

namespace rumi::fuzz {

// As read_window_job() reads it: so many frames of each of its three parts.
Bytes good_window_file(int frames);

}  // namespace rumi::fuzz
