// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <cmath>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "base/log.h"
#include "bus/wire/image_codec.h"
#include "camera_driver/recording/frame_reader.h"

namespace rumi::camera_driver {
namespace {

class VideoReader : public FrameReader {
 public:
  explicit VideoReader(std::string file) : file_(std::move(file)) {
    // What OpenCV would print about a broken file is said by us.
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    rewind();
  }
  bool opened() const { return video_.isOpened(); }

  std::optional<FrameStamp> advance() override {
    if (!video_.grab()) {
      warn_if_short();
      return std::nullopt;
    }
    const double time_ms = video_.get(cv::CAP_PROP_POS_MSEC);
    const int64_t number = count_++;
    return FrameStamp{std::llround(time_ms * 1000), fmt::format("{}: frame {}", file_, number)};
  }
  std::optional<image_t> load(bool colour, std::string* error) override {
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
  void rewind() override {
    // Only FFmpeg: other backends take a file for a pattern of image names, or a camera.
    video_.open(file_, cv::CAP_FFMPEG);
    count_ = 0;
  }

 private:
  void warn_if_short() const {
    constexpr double kPartOfEstimate = 0.95;  // some containers only estimate the number
    const double promised = video_.get(cv::CAP_PROP_FRAME_COUNT);
    if (static_cast<double>(count_) < kPartOfEstimate * promised - 1)
      log_warning("{}: ends after {} images, its header promises {:.0f}: the file may be cut off", file_, count_,
                  promised);
  }
  std::string file_;
  cv::VideoCapture video_;
  int64_t count_ = 0;
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
