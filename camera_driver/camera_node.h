// SPDX-License-Identifier: BSD-3-Clause
// Publishes the images of a source on CAMERA: a recording's paced by the clock when live and one by one when a replay
// asks for them, a camera's as they come.
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

  // Live: publishes what is due. Nothing is left out if reading cannot keep up. Waits for a camera's image.
  void tick(int64_t now_us) override;
  int64_t next_tick_us(int64_t now_us) const override;
  NodeStatus status() override;
  bool done() const override;
  // For a recording: says what was left out, and that somebody ended the process before the end.
  std::vector<std::string> complaints() const override;
  void finish() override { is_finished_ = true; }

  // Replay: the time of the image that publish_next() would publish; nothing at the end. After the first call the node
  // is not live any more: tick() does nothing.
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
  std::optional<image_t> ahead_;  // the next image of a recording; for a camera only inside tick()
  bool live_ = true, is_finished_ = false;
  bool publish_failed_ = false;
  int64_t first_utime_us_ = 0;         // first time of the recording, or of its part where times go back
  std::optional<int64_t> started_us_;  // clock at that image
  int64_t last_utime_us_ = 0;          // of the last published image
  int64_t recorded_us_ = 0;            // recorded time of the last one
  int64_t published_ = 0, late_us_ = 0;
  int64_t progress_us_ = 0, progress_count_ = 0;  // at the last progress line
  double load_ms_ = 0;                            // since the last status
  int64_t loads_ = 0;
};

}  // namespace rumi::camera_driver
