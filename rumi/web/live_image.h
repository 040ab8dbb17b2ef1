// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "base/running/due.h"
#include "bus/transport/bus.h"
#include "lcmtypes/rumi/image_t.hpp"

namespace rumi::tool {

// Keeps the camera's newest image, and returns it reduced, as a JPEG. An image is decoded only if somebody asks for it.
class LiveImage {
 public:
  static constexpr int64_t kPeriodUs = 200'000;  // between two JPEGs, at least

  explicit LiveImage(Bus& bus);
  void set_watched(bool watched) { watched_ = watched; }
  // Returns the time of the newest image. Absent if none has come while somebody looked.
  std::optional<int64_t> utime_us() const;
  // Returns the newest image as a JPEG. A new one is made at most once in kPeriodUs; meanwhile the last one is returned
  // again. Null if there is no image or it is broken.
  std::shared_ptr<const std::string> jpeg(int64_t now_us);

 private:
  bool watched_ = false;
  std::optional<image_t> newest_;
  bool is_new_ = false;
  int64_t made_us_ = kNever_us;
  std::shared_ptr<const std::string> jpeg_;
};

}  // namespace rumi::tool
