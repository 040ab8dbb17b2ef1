// SPDX-License-Identifier: BSD-3-Clause
// The exit codes of Rumi's programs (docs/running.md); 0 means that everything was done.
#pragma once

namespace rumi {

inline constexpr int kDone = 0;
// The work failed.
inline constexpr int kNotDone = 1;
// Wrong options, or another error that starting the program again would not change.
inline constexpr int kNotAgain = 2;
// The work was done, but not with all of the input: more than 1 % of the images were left out for one reason, or more
// than 10 % have no pose in the map. The program has said what is wrong.
inline constexpr int kNotAll = 3;

}  // namespace rumi
