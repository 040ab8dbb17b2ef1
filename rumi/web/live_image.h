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

// The newest image of the camera, smaller, as a JPEG. Images are decoded only if somebody asks for them.
class LiveImage {
 public:
  static constexpr int64_t kPeriodUs = 200'000;  // shortest time from one JPEG to the next

  explicit LiveImage(Bus& bus);
  void set_watched(bool watched) { watched_ = watched; }
  // The time of the image; absent: no image came while somebody looked.
  std::optional<int64_t> utime_us() const;
  // Null if there is no image or it is broken.
  std::shared_ptr<const std::string> jpeg(int64_t now_us);

 private:
  bool watched_ = false;
  std::optional<image_t> newest_;
  bool is_new_ = false;
  int64_t made_us_ = kNever_us;
  std::shared_ptr<const std::string> jpeg_;
};

}  // namespace rumi::tool
