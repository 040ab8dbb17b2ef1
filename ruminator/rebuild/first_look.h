// SPDX-License-Identifier: BSD-3-Clause
// Examines a few images of a window before all of them are matched. Each function returns an Error if the window is
// hopeless.
#pragma once

#include <atomic>

#include "base/result.h"
#include "ruminator/rebuild/window_images.h"
#include "ruminator/window/window_job.h"

namespace rumi::ruminator {

// Returns an Error if the gap is long and none of the images examined in it shows anything.
Result<> look_at_gap(const WindowJob& job, WindowImages& images);

// Returns an Error if the camera only turns or stands still: then there is no depth, and any model would be invented.
// Returns no Error if two images show depth (the first such pair ends the search), or if the images are not all
// connected, because it is unknown then what lies between them. `camera`: the working camera.
Result<> look_at_motion(const Camera& camera, WindowImages& images, const std::atomic<bool>& cancel);

}  // namespace rumi::ruminator
