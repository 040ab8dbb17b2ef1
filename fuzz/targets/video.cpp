// SPDX-License-Identifier: BSD-3-Clause
// A video: its times and its first frames. Byte 0 chooses whether a frame rate is given. Faults of FFmpeg itself are
// not looked for, only faults of our code in handling the numbers and pixels that FFmpeg returns.
#include "bus/wire/calibration.h"
#include "camera_driver/open_source.h"
#include "fuzz/good_messages.h"
#include "fuzz/scratch.h"
#include "tests/formats/write_video.h"
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
  for (int i = 0; opened && i < kMostImages && (*opened)->next(); ++i) {
  }
}

struct Kind {
  const char* container;
  AVCodecID codec = AV_CODEC_ID_H264;
  AVPixelFormat pixels = AV_PIX_FMT_YUV420P;
  int b_frames = 0;
};
constexpr Kind kKinds[] = {{"mp4"},
                           {"mp4", AV_CODEC_ID_H264, AV_PIX_FMT_YUV420P, 2},
                           {"h264"},
                           {"matroska"},
                           {"mpegts"},
                           {"flv"},
                           {"avi", AV_CODEC_ID_MPEG4},
                           {"nut", AV_CODEC_ID_FFV1, AV_PIX_FMT_GRAY16LE},
                           {"matroska", AV_CODEC_ID_VP8}};

std::vector<Bytes> seeds() {
  std::vector<Bytes> all;
  const std::string file = scratch() / "seed";
  for (const Kind& kind : kKinds) {
    testing::VideoOptions options;
    options.frames = 6;
    options.container = kind.container, options.codec = kind.codec, options.pixels = kind.pixels;
    options.b_frames = kind.b_frames;
    if (!testing::write_video(file, options)) continue;  // this build of FFmpeg cannot write it
    all.push_back(
        to_bytes(std::string(1, options.container == std::string("h264") ? '\1' : '\0') + testing::read_file(file)));
  }
  all.push_back(to_bytes(std::string(1, '\0') + "YUV4MPEG2 W64 H48 F30:1 Ip A1:1 C420\nFRAME\n"));
  return all;
}

const Registered registered({"video", run, seeds});

}  // namespace
}  // namespace rumi::fuzz
