// SPDX-License-Identifier: BSD-3-Clause
// Chooses the images of one camera in a folder or list: colour and depth, or left and right, often lie together.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "base/result.h"

namespace rumi {

struct ImageChoice {
  std::vector<size_t> kept;  // indices of the chosen names, in their order
  std::string note;          // what is left out, and how to choose it; may be empty
};

// True if the name of the file or its folder says that the images are not a camera's: "depth/001.png", "001_mask.png".
bool is_no_camera(const std::string& name);

// Sorts the names into kinds: names of one kind differ only in their numbers. Kinds that count alike (left_001,
// right_001) are different cameras, and some kinds are not of a camera by their name (depth, mask). Of these the kind
// is kept whose name is most like a camera's, or the larger one if the names do not decide. A name without a number
// among numbered ones is left out. `pattern` (with * and ?) is compared with the name and with its part behind the last
// '/'. If it is given, all names that fit are kept, and no others; an Error if none fits.
Result<ImageChoice> choose_images(const std::vector<std::string>& names, const std::string& pattern);

}  // namespace rumi
