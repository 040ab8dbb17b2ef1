// SPDX-License-Identifier: BSD-3-Clause
#include "bus/wire/image_options.h"

namespace rumi {

void describe_image(OptionTable& table, int* max_image_side, Pyramid* pyramid) {
  table.group("image");
  table.add("image.max_image_side", max_image_side, "px", "larger images are worked on at this size; 0: never", 0,
            100000);
  table.add("image.levels", &pyramid->levels, "", "sizes of an image in which keypoints are looked for", 1,
            Pyramid::kMostLevels);
  table.add("image.scale_factor", &pyramid->scale_factor, "", "from one of them to the next", Pyramid::kLeastFactor,
            Pyramid::kMostFactor);
  table.for_users({"image.max_image_side"});
}

}  // namespace rumi
