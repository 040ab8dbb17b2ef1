// SPDX-License-Identifier: BSD-3-Clause
// The masks that front_tracker learns: the part of a camera's images that never moves (RUMI_MASK). They are applied to
// the images of a window when it is complete. A mask belongs to the camera, so it is valid for images from before it
// was learned, too.
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
  // Keeps the newest mask of each stream; if there are more than eight streams, forgets one of the oldest session.
  // Returns false if the message is malformed.
  bool take(const mask_t& message);
  // Adds the mask of this stream to the masks in the metadata of the images.
  void put_on(std::vector<image_t>* images, int64_t stream) const;
  size_t streams() const { return masks_.size(); }

 private:
  struct Learned {
    int64_t session = 0, utime_us = 0;
    std::string png;  // decodable; empty if nothing is masked
  };
  void forget_oldest();

  std::map<int64_t, Learned> masks_;  // the newest mask of each stream
};

}  // namespace rumi::ruminator
