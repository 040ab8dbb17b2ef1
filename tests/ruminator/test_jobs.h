// SPDX-License-Identifier: BSD-3-Clause
// Small windows with images, and a builder that knows no COLMAP.
#pragma once

#include <gtest/gtest.h>

#include <atomic>

#include "ruminator/queue/build_worker.h"
#include "ruminator/window/window_job.h"
#include "tests/support/temporary_folder.h"

namespace rumi::testing {
using namespace rumi::ruminator;

// 160 x 120.
Camera small_camera();
// A window of 4 + 5 + 3 frames, 0.1 s apart. Every second tracked frame is a keyframe.
WindowJob small_job(int32_t id = 1, int64_t session = 7);

// A consistent back submap with a keyframe for every image.
Submap fake_submap(const WindowJob& job);
// The result of a builder that registers all frames.
BuildResult fake_result(const WindowJob& job);
// A builder that reports all stages and succeeds. `built` counts its calls.
Builder fake_builder(std::atomic<int>* built = nullptr);

}  // namespace rumi::testing
