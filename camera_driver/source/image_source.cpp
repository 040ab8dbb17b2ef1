// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/source/image_source.h"

#include <fmt/format.h>

namespace rumi::camera_driver {

std::string SkippedFrames::to_string() const {
  std::string out;
  const auto add = [&out](int64_t count, const char* what) {
    if (count > 0) out += fmt::format("{}{} {}", out.empty() ? "" : ", ", count, what);
  };
  add(malformed, "malformed entries");
  add(duplicate, "duplicate times");
  add(out_of_order, "times going backwards");
  add(unreadable, "unreadable images");
  add(wrong_size, "images of another size");
  add(lost, "lost by the camera or its driver");
  return out;
}

}  // namespace rumi::camera_driver
