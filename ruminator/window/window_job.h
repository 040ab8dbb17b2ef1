// SPDX-License-Identifier: BSD-3-Clause
// A window as a job: everything that rebuilding it needs, in memory or in one file, which can be rebuilt on any
// machine. The file is an lcm log: one RUMI_WINDOW_JOB event (the manifest), then the images on CAMERA in order of
// time.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/result.h"
#include "lcmtypes/rumi/image_t.hpp"
#include "ruminator/window/rumination_window.h"
#include "slam/geometry/camera.h"

namespace rumi::ruminator {

inline constexpr const char* kWindowJobChannel = "RUMI_WINDOW_JOB";

// Larger files are refused, because a file is read whole into memory.
inline constexpr int64_t kMaxWindowBytes = int64_t{2} << 30;

struct WindowJob {
  RuminationWindow window;
  Camera camera;
  std::vector<image_t> images;  // for every sample that has an image, in order of time
};

// Writes a temporary file and renames it: the file is there whole or not at all, and still there after a power cut.
// What read_window_job() would refuse is not written, but an Error.
Result<> write_window_job(const std::string& file, const WindowJob& job);
// An Error says what read_window_job() would find wrong with the job.
Result<> check_window_job(const WindowJob& job);

struct WindowJobFile {
  WindowJob job;
  int broken_images = 0;  // left out
};
// An Error has the file, what is wrong with it and where.
Result<WindowJobFile> read_window_job(const std::string& file);
// Reads the window and the camera only, and no image.
Result<WindowJob> read_window_manifest(const std::string& file);

}  // namespace rumi::ruminator
