// SPDX-License-Identifier: BSD-3-Clause
// Takes RUMI_MASK messages: the part of a camera's images that never moves, as front_tracker has learned it. Counts
// malformed messages, and logs the first.
#pragma once

#include <cstdint>

#include "lcmtypes/rumi/mask_t.hpp"
#include "map_server/atlas/atlas.h"

namespace rumi::map_server {

class MaskIntake {
 public:
  // Returns true if the mask is new to the atlas.
  bool take(const mask_t& message, Atlas* atlas);
  int64_t rejected() const { return rejected_; }

 private:
  int64_t rejected_ = 0;
};

}  // namespace rumi::map_server
