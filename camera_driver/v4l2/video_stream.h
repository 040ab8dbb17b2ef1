// SPDX-License-Identifier: BSD-3-Clause
// Streams from a camera: negotiates the format, maps the buffers, takes frames one by one.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "camera_driver/v4l2/capture_clock.h"
#include "camera_driver/v4l2/pixel_format.h"
#include "camera_driver/v4l2/video_device.h"

namespace rumi::camera_driver {

struct StreamRequest {
  int width = 0, height = 0;  // pixels
  double rate_hz = 30;
  std::string format = "auto";  // "auto", or the option name of one of pixel_formats()
};

// The format that the driver agreed to.
struct StreamFormat {
  const PixelFormat* pixels = nullptr;
  int width = 0, height = 0, stride = 0;
  double rate_hz = 0;  // 0: the driver does not say
};

struct StreamFrame {
  RawImage image;
  FrameStamps stamps;  // exposure_us is not set
  uint32_t sequence = 0;
  bool damaged = false;  // the driver says that the image is damaged
};

class VideoStream {
 public:
  ~VideoStream();
  VideoStream(const VideoStream&) = delete;
  VideoStream& operator=(const VideoStream&) = delete;

  const VideoDevice& device() const { return *device_; }
  const StreamFormat& format() const { return format_; }
  // True if the latest failure was that another program uses the camera, which may release it.
  bool busy() const { return busy_; }
  // Starts the stream; no frames come before. Returns why it cannot start, or an empty string.
  std::string start();

  enum class Read { kFrame, kNothing, kFailed };
  // Waits for a frame, at most timeout_ms. The frame's pixels are valid until release(), which must follow before the
  // next read(). After kFailed, *error says why.
  Read read(int timeout_ms, StreamFrame* frame, std::string* error);
  // Gives the frame's memory back to the driver. Returns why that failed, or an empty string.
  std::string release();

 private:
  friend struct OpenedStream open_stream(std::unique_ptr<VideoDevice> device, const StreamRequest& request);
  explicit VideoStream(std::unique_ptr<VideoDevice> device) : device_(std::move(device)) {}
  std::string choose_format(const StreamRequest& request);
  std::string set_format(const PixelFormat& pixels, const StreamRequest& request);
  void set_rate(double rate_hz);
  std::string map_buffers();
  std::string queue(uint32_t index);
  std::string failed(const std::string& what, int error);

  struct Mapping {
    void* start = nullptr;
    size_t length = 0;
  };
  std::unique_ptr<VideoDevice> device_;
  StreamFormat format_;
  std::vector<Mapping> buffers_;
  bool started_ = false, busy_ = false;
  std::optional<uint32_t> held_;  // index of the buffer between read() and release()
};

struct OpenedStream {
  std::unique_ptr<VideoStream> stream;
  std::string error;  // names the device, the fault and what to do; empty: no fault
  bool busy = false;  // see VideoStream::busy()
};
OpenedStream open_stream(std::unique_ptr<VideoDevice> device, const StreamRequest& request);

}  // namespace rumi::camera_driver
