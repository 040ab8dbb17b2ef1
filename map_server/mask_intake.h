// SPDX-License-Identifier: BSD-3-Clause
// Takes RUMI_MASK messages: what front_tracker says that never moves in a camera's images. Messages that make no sense
// are counted, and the first is logged.
#pragma once

#include <cstdint>

#include "lcmtypes/rumi/mask_t.hpp"
#include "map_server/atlas/atlas.h"

namespace rumi::map_server {

class MaskIntake {
 public:
  // Returns true if the atlas has learned something.
  bool take(const mask_t& message, Atlas* atlas);
  int64_t rejected() const { return rejected_; }

 private:
  int64_t rejected_ = 0;
};

}  // namespace rumi::map_server
