// SPDX-License-Identifier: BSD-3-Clause
// Small windows with images, and builders without COLMAP.
#pragma once

#include <gtest/gtest.h>

#include <atomic>

#include "ruminator/queue/build_worker.h"
#include "ruminator/window/window_job.h"
#include "tests/support/temporary_folder.h"

namespace rumi::testing {
using namespace rumi::ruminator;

// Returns a calibration for images of 160 x 120.
Camera small_camera();
// Returns a window of 4 + 5 + 3 frames, 0.1 s apart. Every second tracked frame is a keyframe.
WindowJob small_job(int32_t id = 1, int64_t session = 7);

// Returns a consistent back submap with a keyframe for each image.
Submap fake_submap(const WindowJob& job);
// Returns the result of a builder that has a pose for all frames.
BuildResult fake_result(const WindowJob& job);
// Returns a builder that reports all stages and succeeds. `built`, if given, counts its calls.
Builder fake_builder(std::atomic<int>* built = nullptr);

}  // namespace rumi::testing
