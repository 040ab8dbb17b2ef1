// SPDX-License-Identifier: BSD-3-Clause
// Options on how images are worked on. All processes must use the same ones, or their keypoints would differ.
#pragma once

#include "base/command_line/options.h"
#include "slam/features/pyramid.h"

namespace rumi {

// Adds the section "image" to the options of a process, which keeps the values in its own variables.
void describe_image(OptionTable& table, int* max_image_side, Pyramid* pyramid);

}  // namespace rumi
