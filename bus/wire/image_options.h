// SPDX-License-Identifier: BSD-3-Clause
// How images are worked on: the same in all who look at them, or their keypoints would not be the same.
#pragma once

#include "base/command_line/options.h"
#include "slam/features/pyramid.h"

namespace rumi {

// Section "image". Each process adds it with fields of its own.
void describe_image(OptionTable& table, int* max_image_side, Pyramid* pyramid);

}  // namespace rumi
