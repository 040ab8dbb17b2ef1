// SPDX-License-Identifier: BSD-3-Clause
// Opens a recording or a camera by its name.
#pragma once

#include <string>

#include "camera_driver/options.h"
#include "camera_driver/source/image_source.h"
#include "formats/recording/frame_reader.h"

namespace rumi::camera_driver {

// Opens a recording: a TUM-style folder (rgb.txt), EuRoC folder (mav0/cam0/data.csv, mav0 or cam0 itself), the folder
// above one of them, a folder of images, lcm log, ROS bag or video. The calibration is options.camera_file; else that
// in the images of a log (metadata) or a bag (camera_info); else calibration.yaml beside the data (EuRoC: else
// sensor.yaml). An Error if the first readable image does not have the calibration's size.
OpenedSource open_recording(const std::string& input, const CameraOptions& options);
// Opens the images of a recording as they are; a calibration may be missing. The options files, log_channel and
// grey_range are used, and rate_hz: if it is above 0, images need no times.
OpenedReader open_frames(const std::string& input, const CameraOptions& options);
// Opens a recording, as above, or a camera: /dev/video0, a name in /dev/v4l/by-id, camera:NAME. options.camera_file is
// the camera's calibration.
OpenedSource open_image_source(const std::string& input, const CameraOptions& options);
// True if open_image_source() takes the input for a camera.
bool is_camera(const std::string& input);

}  // namespace rumi::camera_driver
