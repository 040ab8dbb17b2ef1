// SPDX-License-Identifier: BSD-3-Clause
// The mask of the part of a camera's images that never moves (a bonnet, a caption), as front_tracker has learned it.
#pragma once

#include <cstdint>
#include <string>

#include "base/result.h"

namespace rumi::map_server {

struct StillMask {
  int64_t session = 0;   // the session that learned it
  int64_t utime_us = 0;  // time of the image at which the mask was learned
  int width = 0;         // width of the working image, px
  int height = 0;
  double left_out = 0;  // share of the image that is masked
  std::string png;      // width x height, black where masked; empty if nothing is masked
  // True if the two differ at most in utime_us.
  bool is_same(const StillMask& other) const;
  bool is_newer(const StillMask& other) const;
  bool operator==(const StillMask&) const = default;
};

// Returns an Error if the mask of a stream is malformed.
Result<> check(int64_t stream, const StillMask& mask);

}  // namespace rumi::map_server
