// SPDX-License-Identifier: BSD-3-Clause
// Publishes the images of a source on CAMERA. Images of a camera are published as they come; those of a recording at
// the pace of the clock (live), or one by one when a replay asks for them.
#pragma once

#include <memory>

#include "bus/process/process.h"
#include "camera_driver/source/image_source.h"

namespace rumi::camera_driver {

class CameraNode : public Node {
 public:
  CameraNode(Bus& bus, std::unique_ptr<ImageSource> source, const CameraOptions& options);
  // Opens the input; throws std::runtime_error with a message for the user if it cannot be used.
  CameraNode(Bus& bus, const std::string& input, const CameraOptions& options);

  // Live: publishes the images that are due; for a camera, waits for the next image. If reading cannot keep up, images
  // are late, but none is left out.
  void tick(int64_t now_us) override;
  int64_t next_tick_us(int64_t now_us) const override;
  NodeStatus status() override;
  bool done() const override;
  // Says, for a recording, which images were left out, and whether somebody ended the process before the end.
  std::vector<std::string> complaints() const override;
  void finish() override { is_finished_ = true; }

  // Replay: returns the time of the image that publish_next() would publish; nullopt at the end. After the first call
  // the node is no longer live: tick() does nothing.
  std::optional<int64_t> next_utime_us();
  void publish_next();

  const ImageSource& source() const { return *source_; }
  // For looking at the images again after a replay.
  ImageSource& source() { return *source_; }
  void set_controls(const CameraControls& controls) { source_->set_controls(controls); }

 private:
  int64_t due_us() const;
  std::string detail() const;
  void start(int64_t now_us);
  void publish(int64_t now_us);
  void put_on_bus();
  void fetch();
  void pace_anew();
  void report_progress(int64_t now_us);

  Bus& bus_;
  std::unique_ptr<ImageSource> source_;
  CameraOptions options_;
  std::optional<image_t> ahead_;  // the next image; with a camera it is set only inside tick()
  bool live_ = true, is_finished_ = false;
  bool publish_failed_ = false;
  int64_t first_utime_us_ = 0;         // recorded time of the first image, or of the first one since times went back
  std::optional<int64_t> started_us_;  // the bus's time at which that image was due
  int64_t last_utime_us_ = 0;          // utime of the last published image
  int64_t recorded_us_ = 0;            // recorded time of the last published image
  int64_t published_ = 0, late_us_ = 0;
  int64_t progress_us_ = 0, progress_count_ = 0;  // time and published images at the last progress line
  double load_ms_ = 0;                            // total time spent loading images since the last status
  int64_t loads_ = 0;
};

}  // namespace rumi::camera_driver
