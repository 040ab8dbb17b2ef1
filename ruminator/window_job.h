// SPDX-License-Identifier: BSD-3-Clause
// A window as a job: everything that rebuilding it needs, in memory or in one file, which any machine can work on. The
// file is an lcm log: one RUMI_WINDOW_JOB event (the manifest), then the images on CAMERA in order of time.
#pragma once

#include <string>
#include <vector>

#include "lcmtypes/rumi/image_t.hpp"
#include "ruminator/rumination_window.h"
#include "slam/geometry/camera.h"

namespace rumi {

struct WindowJob {
  RuminationWindow window;
  Camera camera;
  std::vector<image_t> images;  // of every sample of the window that has one, in order of time
};

// Writes beside and renames: the file is there whole or not at all. Returns what went wrong, or an empty string.
std::string write_window_job(const std::string& file, const WindowJob& job);

struct WindowJobFile {
  WindowJob job;
  std::string error;  // empty, or the file, what is wrong with it and where
  bool ok() const { return error.empty(); }
};
WindowJobFile read_window_job(const std::string& file);

}  // namespace rumi
