// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "bus/wire/image_codec.h"
#include "camera_driver/recording/frame_reader.h"
#include "camera_driver/recording/video_times.h"

namespace rumi::camera_driver {
namespace {

class VideoReader : public FrameReader {
 public:
  explicit VideoReader(std::string file) : file_(std::move(file)), times_(read_video_times(file_)) {
    // What OpenCV would print about a broken file is said by us.
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    if (!times_.utimes.empty()) open();
  }
  bool opened() const { return video_.isOpened() && !times_.utimes.empty(); }

  const std::vector<int64_t>& utimes() const override { return times_.utimes; }
  std::string why_no_times() const override { return times_.has_times ? "" : "the images of the video have no times"; }
  std::string where(size_t frame) const override { return fmt::format("{}: frame {}", file_, frame); }
  std::optional<image_t> load(size_t frame, bool colour, std::string* error) override {
    if (frame + 1 < grabbed_) open();
    while (grabbed_ <= frame && video_.grab()) ++grabbed_;
    if (grabbed_ <= frame) {
      *error = fmt::format("{}: it ends after {} of {} images: is it cut off?", file_, grabbed_, times_.utimes.size());
      return std::nullopt;
    }
    cv::Mat pixels, grey;
    if (!video_.retrieve(pixels) || pixels.empty()) {
      *error = file_ + ": a frame could not be decoded";
      return std::nullopt;
    }
    if (pixels.channels() == 1) return make_grey_image(0, pixels);
    if (colour) return make_rgb_image(0, pixels);
    cv::cvtColor(pixels, grey, cv::COLOR_BGR2GRAY);
    return make_grey_image(0, grey);
  }
  std::vector<std::string> notes() const override {
    constexpr double kTolerable = 0.95;
    if (static_cast<double>(times_.stored) >= kTolerable * static_cast<double>(times_.promised) - 1) return {};
    return {fmt::format("ends after {} images, its header promises {}: the file may be cut off", times_.stored,
                        times_.promised)};
  }

 private:
  void open() {
    // Only FFmpeg: other backends take a file for a pattern of image names, or a camera.
    video_.open(file_, cv::CAP_FFMPEG);
    grabbed_ = 0;
  }

  std::string file_;
  VideoTimes times_;
  cv::VideoCapture video_;
  size_t grabbed_ = 0;  // frames
};

}  // namespace

OpenedReader open_video(const std::filesystem::path& file) {
  auto reader = std::make_unique<VideoReader>(file.string());
  if (!reader->opened())
    return {nullptr, fmt::format("{}: is neither an lcm log nor a video that can be decoded; give a dataset folder, an "
                                 "image folder, a video or an lcm log",
                                 file.string())};
  return {std::move(reader), ""};
}

}  // namespace rumi::camera_driver
