// SPDX-License-Identifier: BSD-3-Clause
// The part of a camera's images that never moves (a bonnet, a caption), as front_tracker has learned it.
#pragma once

#include <cstdint>
#include <string>

#include "base/result.h"

namespace rumi::map_server {

struct StillMask {
  int64_t session = 0;   // the session that learned it
  int64_t utime_us = 0;  // of the image at which it was learned
  int width = 0;         // of the images as they are worked on
  int height = 0;
  double left_out = 0;  // share of the image
  std::string png;      // of that size, black where pixels are left out; empty if none are
  // True if the other one says the same, maybe at another time.
  bool is_same(const StillMask& other) const;
  bool is_newer(const StillMask& other) const;
  bool operator==(const StillMask&) const = default;
};

// An Error says what is wrong with the mask of a stream.
Result<> check(int64_t stream, const StillMask& mask);

}  // namespace rumi::map_server
