// SPDX-License-Identifier: BSD-3-Clause
// A synthetic sequence with its truth. Frames can be rendered in any order.
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>

#include "slam/geometry/transform.h"
#include "synth/options.h"

namespace rumi::synth {

class SequenceRenderer {
 public:
  // Builds the room, which takes seconds. Throws std::runtime_error, with a message for the user, if the options or the
  // path file cannot be used.
  explicit SequenceRenderer(const SynthOptions& options);
  ~SequenceRenderer();

  int frames() const;
  int64_t utime_us(int frame) const;
  SE3 map_from_cam(int frame) const;  // truth in the middle of the exposure, with hard rotations
  const Camera& camera() const;
  // Returns CV_8UC1 if options.grey, else CV_8UC3 (BGR). The same options give the same image, in whatever order frames
  // are rendered.
  cv::Mat render(int frame);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rumi::synth
