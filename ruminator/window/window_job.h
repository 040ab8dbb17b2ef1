// SPDX-License-Identifier: BSD-3-Clause
// A window as a job: everything needed to rebuild it, in memory or in one file, which can be rebuilt on any machine.
// The file is an LCM log: one RUMI_WINDOW_JOB event (the manifest), then the images on CAMERA in order of time.
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

// Larger files are refused, because a file is read into memory as a whole.
inline constexpr int64_t kMaxWindowBytes = int64_t{2} << 30;

struct WindowJob {
  RuminationWindow window;
  Camera camera;
  std::vector<image_t> images;  // images of all samples that have one, in order of time
};

// Writes a temporary file and renames it, so that the file is complete or does not exist, even after a power cut.
// Returns an Error, and writes no file, if read_window_job() would refuse the job.
Result<> write_window_job(const std::string& file, const WindowJob& job);
// Returns the Error that read_window_job() would return for the job.
Result<> check_window_job(const WindowJob& job);

struct WindowJobFile {
  WindowJob job;
  int broken_images = 0;  // images left out because they are damaged
};
// Reads the file of a job. An Error names the file, the fault and its place in the file.
Result<WindowJobFile> read_window_job(const std::string& file);
// Reads only the window and the camera, without any image.
Result<WindowJob> read_window_manifest(const std::string& file);

}  // namespace rumi::ruminator
