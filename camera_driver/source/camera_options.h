// SPDX-License-Identifier: BSD-3-Clause
// Options that say which images of a recording or camera are published, when, and in which form.
#pragma once

#include <string>

namespace rumi::camera_driver {

// Controls of a camera, which may change while it runs. An empty one is left as it is.
struct CameraControls {
  std::string exposure;       // auto, or ms
  std::string gain;           // auto, or the camera's number
  std::string white_balance;  // auto, or kelvin
  std::string focus;          // auto, or the camera's number
  std::string power_line;     // off, 50, 60 (Hz) or auto
  std::string controls;       // any others by name: "brightness=10, sharpness=0"
  double lock_auto_s = 0;     // so long after the start, exposure, gain and white balance are fixed; 0: never
};

struct CameraOptions : CameraControls {
  std::string camera_file;  // calibration; empty: beside the data, or in the log
  std::string mask;         // file or folder, or kNoMask; empty: the mask beside the data
  int every = 1;            // N: every Nth frame is published
  double start_s = 0;       // seconds that are skipped at the beginning
  double duration_s = 0;    // seconds that are played; 0: to the end
  bool loop = false;        // again and again; times keep rising
  // Recording: new times at this rate, 0: as recorded; camera: asked for, 0: the calibration's fps, else 30.
  double rate_hz = 0;
  double speed = 1;                    // live only: pace relative to the times
  bool live_stamps = false;            // live only: utime is when the image is published
  std::string encoding = "auto";       // auto: JPEG files as they are, all else grey; or grey, rgb, jpeg
  std::string log_channel = "CAMERA";  // channel of the images in an lcm log, or their topic in a bag
  std::string files;                   // pattern of the images of a folder or list; empty: those of one camera
  std::string grey_range = "auto";     // range of 16-bit pixels, see parse_grey_range(); auto: that of the recording

  // Cameras only.
  int width = 0, height = 0;    // pixels, 0: those of the calibration, without one 640 x 480
  std::string format = "auto";  // see pixel_formats(); auto: what reaches the rate with least work and loss
  double stall_s = 3;           // after so long without an image, the camera is opened again
};

}  // namespace rumi::camera_driver
