// SPDX-License-Identifier: BSD-3-Clause
// Identifies an image by time and stream. Time alone is ambiguous: in every folder of images without times, the times
// begin at 0.
#pragma once

#include <compare>
#include <cstdint>

namespace rumi {

// Ids sort by time.
struct ImageId {
  int64_t utime_us = 0;
  int64_t stream = 0;  // a camera, or a recording; see docs/wire.md
  auto operator<=>(const ImageId&) const = default;
};

}  // namespace rumi
