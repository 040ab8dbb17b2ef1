// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "formats/truth/trajectory.h"
#include "synth/sequence_renderer.h"

namespace rumi {

struct RenderedImages {
  Camera camera;
  std::vector<int64_t> utime_us;
  std::vector<cv::Mat> grey;
  std::vector<TimedPose> truth;
};

// Returns 3 seconds of the default walk at 640x480 and 30 Hz. They are rendered at the first call.
inline const RenderedImages& rendered_images() {
  static const RenderedImages images = [] {
    synth::SynthOptions options;
    options.seconds = 3;
    options.grey = true;
    synth::SequenceRenderer renderer(options);
    RenderedImages made;
    made.camera = renderer.camera();
    for (int i = 0; i < renderer.frames(); ++i) {
      made.utime_us.push_back(renderer.utime_us(i));
      made.grey.push_back(renderer.render(i));
      made.truth.push_back({renderer.utime_us(i), renderer.map_from_cam(i)});
    }
    return made;
  }();
  return images;
}

}  // namespace rumi
