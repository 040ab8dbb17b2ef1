// SPDX-License-Identifier: BSD-3-Clause
// A look at a few images of a window, before anything is spent on it: does the camera move, or does it only turn or
// stand still? Then there is no depth, and whatever would be rebuilt would be invented.
#pragma once

#include <atomic>
#include <map>
#include <string>

#include "ruminator/rebuild/build_options.h"
#include "ruminator/window/window_job.h"

namespace rumi::ruminator {

struct WindowLook {
  // Why there is nothing to rebuild, a sentence for a person. Empty: two images show depth, or the images looked at do
  // not hang together and what lies between them is not known.
  std::string hopeless;
  std::map<size_t, SiftFeatures> features;  // of the images looked at, by their index in the job
};

// Ends with the first pair of images that shows depth. `camera`: the working camera.
WindowLook look_at_motion(const WindowJob& job, const Camera& camera, const BuildOptions& options,
                          const std::atomic<bool>& cancel);

}  // namespace rumi::ruminator
