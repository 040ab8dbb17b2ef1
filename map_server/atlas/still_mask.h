// SPDX-License-Identifier: BSD-3-Clause
// What never moves in the images of a camera (a bonnet, a caption), as front_tracker has learned it.
#pragma once

#include <cstdint>
#include <string>

#include "base/result.h"

namespace rumi::map_server {

struct StillMask {
  int64_t session = 0;   // that it was learned in
  int64_t utime_us = 0;  // of the image at which it was
  int width = 0;         // of the images as they are worked on
  int height = 0;
  double left_out = 0;  // share of the image
  std::string png;      // of that size, black: left out; empty: nothing is
  // Whether the other one says the same, be it at another time.
  bool is_same(const StillMask& other) const;
  bool is_newer(const StillMask& other) const;
  bool operator==(const StillMask&) const = default;
};

// An Error says what is wrong with the mask of a stream.
Result<> check(int64_t stream, const StillMask& mask);

}  // namespace rumi::map_server
