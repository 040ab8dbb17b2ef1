// SPDX-License-Identifier: BSD-3-Clause
// A V4L2 camera as an ImageSource. If something goes wrong while it runs, that is logged, and the camera is opened
// again until it works.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "camera_driver/source/frame_selector.h"
#include "camera_driver/source/image_source.h"
#include "camera_driver/v4l2/capture_clock.h"
#include "camera_driver/v4l2/video_stream.h"

namespace rumi::camera_driver {

class V4l2Source : public ImageSource {
 public:
  // `input`: see names_camera(). If there is no calibration, fx of `camera` is 0, and images carry no calibration.
  V4l2Source(VideoSystem& system, std::string input, const Camera& camera, const CameraOptions& options);

  // Sets the mask of all images, a PNG for their metadata.
  void use_mask(std::string png) { mask_ = std::move(png); }
  // Opens the camera. Returns why it cannot be used, or an empty string. A camera that is busy is no failure: next()
  // waits for it.
  std::string start();

  std::optional<image_t> next() override;
  const Camera& camera() const override { return camera_; }
  const std::string& name() const override { return input_; }
  int64_t total() const override { return -1; }
  const SkippedFrames& skipped() const override { return skipped_; }
  const LiveState* live() const override { return &live_; }
  void set_controls(const CameraControls& controls) override;

 private:
  std::string open();
  std::string open_device(std::unique_ptr<VideoDevice>* device);
  bool reopen();
  void lose(const std::string& why);
  void retry_later();
  void check_stall();
  void set_up_controls();
  void note(const StreamFrame& frame);
  void count_gap(uint32_t sequence);
  void lock_when_warm(int64_t now_us);
  void measure_rate(int64_t utime_us);
  std::optional<image_t> accept(StreamFrame& frame);
  void skip(int64_t SkippedFrames::*reason, const std::string& message);

  VideoSystem& system_;
  std::string input_, calibration_;
  std::string mask_;  // PNG of each image's mask, or empty
  Camera camera_;
  CameraOptions options_;
  FrameSelector selector_;
  CaptureClock clock_;
  SkippedFrames skipped_;
  LiveState live_;

  std::string card_;  // name of the camera that was opened first
  std::unique_ptr<VideoStream> stream_;
  bool busy_ = false, clock_warned_ = false, rate_warned_ = false, locked_ = false;
  int64_t exposure_us_ = 0;  // exposure time of each image; 0: not known
  // Times of CLOCK_MONOTONIC; retry_delay_us_ is a duration.
  int64_t retry_at_us_ = 0, retry_delay_us_ = 0, gone_at_us_ = 0;
  int64_t last_frame_us_ = 0;  // arrival of the last frame, or the start of streaming
  std::optional<int64_t> first_frame_us_;
  std::optional<uint32_t> last_sequence_;
  int64_t rate_from_us_ = 0, rate_count_ = 0;  // begin and number of images of the rate's measurement
};

// Opens a camera: options.camera_file is its calibration, and may be missing.
OpenedSource open_camera(VideoSystem& system, const std::string& input, const CameraOptions& options);

}  // namespace rumi::camera_driver
