// SPDX-License-Identifier: BSD-3-Clause
// What a program returns besides 0 (done), 1 (not done) and 2 (wrong options).
#pragma once

namespace rumi {

// The work was done, but not with all of the input: more than 1 % of the images were left out for one reason, or more
// than 10 % have no pose in the map. What is wrong was said.
inline constexpr int kNotAll = 3;

}  // namespace rumi
