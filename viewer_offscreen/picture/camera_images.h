// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <functional>

#include "lcmtypes/rumi/image_t.hpp"
#include "lcmtypes/rumi/track_t.hpp"
#include "slam/map/submap.h"
#include "viewer_offscreen/scene/scene.h"

namespace rumi::viewer_offscreen {

// Keeps the latest images of the camera, and the images of the latest keyframes until the submap brings their
// keypoints: a few of each. An image is decoded only when it is drawn.
class CameraImages {
 public:
  void add(const image_t& image);
  void add(const track_t& track);

  // Returns the image of the latest keyframe that a submap has, with its keypoints. If that image is much older than
  // the latest one, returns the latest image without keypoints. The view has no image if none has come or it cannot be
  // decoded. `find(key)` returns the submap, or nullptr. Times are counted from `first_us`.
  CameraView view(int64_t first_us, const std::function<const Submap*(SubmapKey)>& find) const;

 private:
  struct KeyframeImage {
    SubmapKey submap;
    image_t image;
  };
  std::deque<image_t> recent_;  // in order of arrival
  std::deque<KeyframeImage> keyframes_;
  track_t latest_{};
};

}  // namespace rumi::viewer_offscreen
