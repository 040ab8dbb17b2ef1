// SPDX-License-Identifier: BSD-3-Clause
// A recording or a camera, by its name.
#pragma once

#include <string>

#include "camera_driver/options.h"
#include "camera_driver/source/image_source.h"
#include "formats/recording/frame_reader.h"

namespace rumi::camera_driver {

// input: TUM-style folder (rgb.txt), EuRoC folder (mav0/cam0/data.csv, mav0 or cam0 itself), the folder above one of
// them, folder of images, lcm log, ROS bag or video. The camera comes from options.camera_file, else calibration.yaml
// beside the data (EuRoC: else sensor.yaml); in a log from the images' metadata, in a bag from its camera_info, else
// calibration.yaml beside it. Fails if the first readable image does not fit it.
OpenedSource open_recording(const std::string& input, const CameraOptions& options);
// The images of a recording as they are, without a calibration; of the options, log_channel and rate_hz (times of a
// folder of images, where their names tell none) are used.
OpenedReader open_frames(const std::string& input, const CameraOptions& options);
// Opens a recording, as above, or a camera: /dev/video0, a name in /dev/v4l/by-id, camera:NAME. options.camera_file is
// the camera's calibration.
OpenedSource open_image_source(const std::string& input, const CameraOptions& options);
// True for what open_image_source() takes for a camera.
bool is_camera(const std::string& input);

}  // namespace rumi::camera_driver
