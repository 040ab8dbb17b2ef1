// SPDX-License-Identifier: BSD-3-Clause
// A video: its times, and its first frames. Byte 0 chooses whether there is a rate. FFmpeg's own faults are its own:
// what is looked for is what becomes of the numbers that it hands over.
#include <opencv2/videoio.hpp>

#include "bus/wire/camera_file.h"
#include "camera_driver/open_source.h"
#include "camera_driver/recording/video_times.h"
#include "fuzz/good_messages.h"
#include "fuzz/scratch.h"
#include "tests/camera_driver/write_video.h"
#include "tests/support/temporary_folder.h"

namespace rumi::fuzz {
namespace {

constexpr int kMostImages = 4;

void run(View input) {
  if (input.empty()) return;
  camera_driver::CameraOptions options;
  options.camera_file = scratch().write("calibration.yaml", to_bytes(camera_to_yaml(good_camera())));
  options.rate_hz = (input[0] & 1) != 0 ? 30 : 0;
  const std::string file = scratch().write("video", input.subspan(1));
  const camera_driver::OpenedSource opened = camera_driver::open_recording(file, options);
  for (int i = 0; opened.ok() && i < kMostImages && opened.source->next(); ++i) {
  }
}

// Files of a few kilobytes.
std::vector<std::string> videos() {
  std::vector<std::string> files;
  testing::VideoOptions options;
  options.frames = 6;
  for (const int b_frames : {0, 2}) {
    options.b_frames = b_frames;
    files.push_back(scratch() / ("seed" + std::to_string(b_frames) + ".mp4"));
    testing::write_video(files.back(), options);
  }
  options.has_times = false;
  files.push_back(scratch() / "seed.h264");
  testing::write_video(files.back(), options);
  for (const char* name : {"seed.avi", "seed.mkv", "seed.mov"}) {
    files.push_back(scratch() / name);
    cv::VideoWriter writer(files.back(), cv::CAP_FFMPEG, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 20,
                           cv::Size(kWidth, kHeight));
    for (int i = 0; writer.isOpened() && i < 3; ++i) writer.write(cv::Mat(kHeight, kWidth, CV_8UC3, cv::Scalar(9 * i)));
  }
  return files;
}

std::vector<Bytes> seeds() {
  std::vector<Bytes> all;
  for (const std::string& file : videos()) {
    const std::string bytes = testing::read_file(file);
    if (bytes.empty()) continue;  // this FFmpeg cannot write such a video
    all.push_back(to_bytes(std::string(1, file.ends_with(".h264") ? '\1' : '\0') + bytes));
  }
  all.push_back(to_bytes(std::string(1, '\0') + "YUV4MPEG2 W64 H48 F30:1 Ip A1:1 C420\nFRAME\n"));
  return all;
}

const Registered registered({"video", run, seeds});

}  // namespace
}  // namespace rumi::fuzz
