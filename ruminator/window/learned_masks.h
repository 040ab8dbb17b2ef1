// SPDX-License-Identifier: BSD-3-Clause
// The masks that front_tracker learns: what never moves in the images of a camera (RUMI_MASK). They are put on the
// images of a window when it is complete. A mask learned late holds for earlier images, too, because it belongs to the
// camera.
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
  // Keeps the newest mask of each stream. False if the message cannot be used.
  bool take(const mask_t& message);
  // Adds the mask of this stream to the masks of the images.
  void put_on(std::vector<image_t>* images, int64_t stream) const;
  size_t streams() const { return masks_.size(); }

 private:
  struct Learned {
    int64_t session = 0, utime_us = 0;
    std::string png;  // decodable; empty: nothing is left out
  };
  void forget_oldest();

  std::map<int64_t, Learned> masks_;  // by stream
};

}  // namespace rumi::ruminator
