// SPDX-License-Identifier: BSD-3-Clause
// A window as a job: everything that rebuilding it needs, in memory or in one file, which any machine can work on. The
// file is an lcm log: one RUMI_WINDOW_JOB event (the manifest), then the images on CAMERA in order of time.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lcmtypes/rumi/image_t.hpp"
#include "ruminator/window/rumination_window.h"
#include "slam/geometry/camera.h"

namespace rumi::ruminator {

inline constexpr const char* kWindowJobChannel = "RUMI_WINDOW_JOB";

// A file is read whole into memory: larger ones are refused.
inline constexpr int64_t kMaxWindowBytes = int64_t{2} << 30;

struct WindowJob {
  RuminationWindow window;
  Camera camera;
  std::vector<image_t> images;  // of every sample of the window that has one, in order of time
};

// Writes beside and renames: the file is there whole or not at all, and still there after a power cut. Returns what
// went wrong, or an empty string. What read_window_job would refuse is not written.
std::string write_window_job(const std::string& file, const WindowJob& job);
// What read_window_job would find wrong with it, or an empty string.
std::string check_window_job(const WindowJob& job);

struct WindowJobFile {
  WindowJob job;
  int broken_images = 0;  // left out
  std::string error;      // empty, or the file, what is wrong with it and where
  bool ok() const { return error.empty(); }
};
WindowJobFile read_window_job(const std::string& file);
// The same without the images.
WindowJobFile read_window_manifest(const std::string& file);

}  // namespace rumi::ruminator
