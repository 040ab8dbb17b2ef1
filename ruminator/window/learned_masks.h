// SPDX-License-Identifier: BSD-3-Clause
// What front_tracker has learned that never moves in a camera's images (RUMI_MASK). It is put on the images of a window
// when that is complete: what was learned late holds for those before, too, because it is of the camera.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "lcmtypes/rumi/image_t.hpp"
#include "lcmtypes/rumi/mask_t.hpp"

namespace rumi::ruminator {

class LearnedMasks {
 public:
  // The newest of each stream counts. False: it cannot be used.
  bool take(const mask_t& message);
  // What it leaves out, too, is left out of each of the images of this stream.
  void put_on(std::vector<image_t>* images, int64_t stream) const;
  size_t streams() const { return masks_.size(); }

 private:
  struct Learned {
    int64_t session = 0, utime_us = 0;
    std::string png;  // that can be decoded; empty: nothing is left out
  };
  void forget_oldest();

  std::map<int64_t, Learned> masks_;  // by stream
};

}  // namespace rumi::ruminator
