// SPDX-License-Identifier: BSD-3-Clause
// Chooses the images of one camera in a folder or list: colour and depth, or left and right, often lie together.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "base/result.h"

namespace rumi {

struct ImageChoice {
  std::vector<size_t> kept;  // indices of names, in their order
  std::string note;          // what is left out, and how to choose it; may be empty
};

// Judges by the names of the file and its folder: "depth/001.png", "001_mask.png".
bool is_no_camera(const std::string& name);

// Names of one kind are alike but for their numbers. Kinds that count alike (left_001, right_001), or that are not of a
// camera by their name (depth, mask), are told apart: the kind that is most a camera's by its name is kept, of equals
// the larger. A name without a number among numbered ones is left out.
// `pattern` (with * and ?) is compared with the name and with its part behind the last '/'; if it is given, all names
// that fit are kept, and no others. An Error if none fits.
Result<ImageChoice> choose_images(const std::vector<std::string>& names, const std::string& pattern);

}  // namespace rumi
