// SPDX-License-Identifier: BSD-3-Clause
// What of a recording is published, when, and in which form.
#pragma once

#include <string>

#include "bus/options.h"

namespace rumi {

struct CameraOptions {
  std::string camera_file;        // calibration; empty: beside the data, or in the log
  int every = 1;                  // frames: publish every Nth
  double start_s = 0;             // skipped at the beginning
  double duration_s = 0;          // of the recording from there on, 0: all
  bool loop = false;              // again and again; times keep rising
  double rate_hz = 0;             // new times at this rate instead of the recorded ones, 0: as recorded
  double speed = 1;               // live only: pace relative to the times
  bool live_stamps = false;       // live only: utime is when the image is published
  std::string encoding = "auto";  // auto: JPEG files as they are, all else grey; or grey, rgb, jpeg
  int jpeg_quality = 90;
  std::string log_channel = "CAMERA";  // of the images in an lcm log

  // What is wrong with it, naming the field and its value; empty if nothing.
  std::string check() const;
};

void describe(OptionTable& table, CameraOptions& options);

}  // namespace rumi
