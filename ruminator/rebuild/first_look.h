// SPDX-License-Identifier: BSD-3-Clause
// A look at a few images of a window, before all of them are matched. Each function returns an Error if the window is
// hopeless.
#pragma once

#include <atomic>

#include "base/result.h"
#include "ruminator/rebuild/window_images.h"
#include "ruminator/window/window_job.h"

namespace rumi::ruminator {

// An Error if none of some images of a long gap shows anything.
Result<> look_at_gap(const WindowJob& job, WindowImages& images);

// An Error if the camera only turns or stands still: then there is no depth, and whatever was rebuilt would be
// invented. No Error if two images show depth (the look ends with the first such pair), or if the images do not hang
// together, because it is not known then what lies between them. `camera`: the working camera.
Result<> look_at_motion(const Camera& camera, WindowImages& images, const std::atomic<bool>& cancel);

}  // namespace rumi::ruminator
