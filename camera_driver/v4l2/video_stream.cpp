// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/v4l2/video_stream.h"

#include <fmt/format.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>

namespace rumi::camera_driver {
namespace {

constexpr uint32_t kBuffers = 4;  // at 30 Hz no frame is lost if nobody reads for 100 ms
constexpr uint32_t kBufType = V4L2_BUF_TYPE_VIDEO_CAPTURE;
constexpr double kRateTolerance = 0.95;    // this share of the wanted rate counts as reaching it
constexpr int64_t kMostBytes = 256 << 20;  // size of the largest frame

v4l2_buffer empty_buffer(uint32_t index = 0) {
  v4l2_buffer buffer{};
  buffer.type = kBufType;
  buffer.memory = V4L2_MEMORY_MMAP;
  buffer.index = index;
  return buffer;
}

// Returns 0 if the time is negative or would overflow.
int64_t microseconds(const timeval& time) {
  constexpr int64_t kMostSeconds = int64_t{1} << 40, kMostMicroseconds = 1'000'000;
  if (time.tv_sec < 0 || time.tv_sec > kMostSeconds) return 0;
  return int64_t{time.tv_sec} * 1'000'000 + std::clamp<int64_t>(time.tv_usec, 0, kMostMicroseconds);
}

struct Candidate {
  const PixelFormat* pixels = nullptr;
  double rate_hz = 0;
};

std::string offered_sizes(const VideoDevice& device, const std::vector<const PixelFormat*>& formats) {
  std::vector<std::string> sizes;
  for (const PixelFormat* format : formats)
    for (const SizeRange& size : sizes_of(device, format->fourcc))
      if (const std::string text = size.to_string(); std::find(sizes.begin(), sizes.end(), text) == sizes.end())
        sizes.push_back(text);
  return fmt::format("{}", fmt::join(sizes, ", "));
}

std::vector<const PixelFormat*> usable_formats(const VideoDevice& device, const std::string& wanted) {
  const std::vector<uint32_t> offered = pixel_formats_of(device);
  std::vector<const PixelFormat*> usable;
  for (const PixelFormat& format : pixel_formats()) {
    const bool is_offered = std::find(offered.begin(), offered.end(), format.fourcc) != offered.end();
    if (is_offered && (wanted == "auto" || wanted == format.option)) usable.push_back(&format);
  }
  return usable;
}

std::string offered_formats(const VideoDevice& device) {
  std::string text;
  for (const uint32_t fourcc : pixel_formats_of(device)) {
    const PixelFormat* format = find_pixel_format(fourcc);
    text += (text.empty() ? "" : ", ") + (format ? format->option : fourcc_text(fourcc));
  }
  return text.empty() ? "none" : text;
}

}  // namespace

VideoStream::~VideoStream() {
  int type = kBufType;
  if (started_) device_->ioctl(VIDIOC_STREAMOFF, &type);
  for (const Mapping& buffer : buffers_) device_->system().unmap(buffer.start, buffer.length);
}

std::string VideoStream::failed(const std::string& what, int error) {
  busy_ = error == EBUSY;
  const std::string& path = device_->path();
  if (error == EBUSY) return fmt::format("{}: is in use by another program (fuser -v {} tells which)", path, path);
  if (error == ENODEV) return fmt::format("{}: the camera is gone", path);
  if (error == ENOSPC)
    return fmt::format(
        "{}: the USB bus has no bandwidth left for {} {} x {}: choose camera_driver.format mjpeg, a smaller "
        "size or rate, or another USB port",
        path, format_.pixels ? format_.pixels->option : "", format_.width, format_.height);
  return fmt::format("{}: {}: {}", path, what, std::strerror(error));
}

// Chooses the first format in order of preference that reaches the wanted rate at the wanted size, else the fastest
// one. Returns why none can be used, or an empty string.
std::string VideoStream::choose_format(const StreamRequest& request) {
  const std::string& path = device_->path();
  const std::vector<const PixelFormat*> usable = usable_formats(*device_, request.format);
  if (usable.empty())
    return fmt::format("{}: has no format that is wanted (camera_driver.format is {}); it offers {}", path,
                       request.format, offered_formats(*device_));
  std::optional<Candidate> best;
  for (const PixelFormat* pixels : usable) {
    const std::vector<SizeRange> sizes = sizes_of(*device_, pixels->fourcc);
    const bool fits = sizes.empty() || std::any_of(sizes.begin(), sizes.end(), [&](const SizeRange& size) {
                        return size.contains(request.width, request.height);
                      });
    if (!fits) continue;
    const Candidate candidate{
        pixels, nearest_rate(rates_of(*device_, pixels->fourcc, request.width, request.height), request.rate_hz)};
    if (!best || candidate.rate_hz > best->rate_hz) best = candidate;
    if (best->rate_hz >= kRateTolerance * request.rate_hz) break;
  }
  if (!best)
    return fmt::format(
        "{}: does not offer {} x {} pixels; it offers {}. The size is that of the calibration, or "
        "camera_driver.width and height",
        path, request.width, request.height, offered_sizes(*device_, usable));
  return set_format(*best->pixels, request);
}

std::string VideoStream::set_format(const PixelFormat& pixels, const StreamRequest& request) {
  v4l2_format format{};
  format.type = kBufType;
  format.fmt.pix.width = static_cast<uint32_t>(request.width);
  format.fmt.pix.height = static_cast<uint32_t>(request.height);
  format.fmt.pix.pixelformat = pixels.fourcc;
  format.fmt.pix.field = V4L2_FIELD_NONE;
  if (const int result = device_->ioctl(VIDIOC_S_FMT, &format); result < 0)
    return failed(fmt::format("refuses {} {} x {}", pixels.option, request.width, request.height), -result);
  const v4l2_pix_format& got = format.fmt.pix;
  const auto width = static_cast<uint32_t>(request.width), height = static_cast<uint32_t>(request.height);
  if (got.pixelformat != pixels.fourcc || got.width != width || got.height != height)
    return fmt::format("{}: asked for {} {} x {}, the camera wants to give {} {} x {}", device_->path(), pixels.option,
                       width, height, fourcc_text(got.pixelformat), got.width, got.height);
  if (got.field == V4L2_FIELD_ALTERNATE || got.field == V4L2_FIELD_TOP || got.field == V4L2_FIELD_BOTTOM)
    return fmt::format("{}: gives half images (interlaced), which are not supported", device_->path());
  const int64_t stride = got.bytesperline > 0 ? got.bytesperline : row_bytes(pixels, request.width);
  if (pixels.layout != PixelLayout::kJpeg) {
    const bool plausible =
        stride <= kMostBytes &&
        frame_bytes(pixels, request.width, request.height, static_cast<int>(stride)).value_or(kMostBytes) < kMostBytes;
    if (!plausible)
      return fmt::format("{}: {} {} x {} with {} bytes from row to row cannot be", device_->path(), pixels.option,
                         width, height, stride);
  }
  format_ = {&pixels, request.width, request.height, static_cast<int>(stride), 0};
  return {};
}

void VideoStream::set_rate(double rate_hz) {
  constexpr uint32_t kParts = 100'000;
  v4l2_streamparm parameters{};
  parameters.type = kBufType;
  // Makes a whole rate a simple fraction, 1/30 and not 33333/1000000: drivers compare it with their own.
  const bool whole = std::abs(rate_hz - std::round(rate_hz)) < 1e-6;
  parameters.parm.capture.timeperframe.numerator = whole ? 1 : kParts;
  parameters.parm.capture.timeperframe.denominator =
      static_cast<uint32_t>(std::llround(whole ? rate_hz : rate_hz * kParts));
  // Some drivers do not know rates, which is no fault.
  if (device_->ioctl(VIDIOC_S_PARM, &parameters) < 0) return;
  const v4l2_fract& got = parameters.parm.capture.timeperframe;
  if (got.numerator > 0) format_.rate_hz = static_cast<double>(got.denominator) / got.numerator;
}

std::string VideoStream::map_buffers() {
  v4l2_requestbuffers request{};
  request.count = kBuffers;
  request.type = kBufType;
  request.memory = V4L2_MEMORY_MMAP;
  if (const int result = device_->ioctl(VIDIOC_REQBUFS, &request); result < 0)
    return failed("gives no memory for images", -result);
  if (request.count < 1 || request.count > VIDEO_MAX_FRAME)
    return fmt::format("{}: offers {} buffers", device_->path(), request.count);
  for (uint32_t i = 0; i < request.count; ++i) {
    v4l2_buffer buffer = empty_buffer(i);
    if (const int result = device_->ioctl(VIDIOC_QUERYBUF, &buffer); result < 0)
      return failed("gives no memory for images", -result);
    if (buffer.length == 0 || buffer.length > kMostBytes)
      return fmt::format("{}: a buffer of {} bytes cannot be", device_->path(), buffer.length);
    void* start = device_->system().map(device_->fd(), buffer.length, buffer.m.offset);
    if (!start) return fmt::format("{}: its memory cannot be mapped", device_->path());
    buffers_.push_back({start, buffer.length});
  }
  return {};
}

std::string VideoStream::queue(uint32_t index) {
  v4l2_buffer buffer = empty_buffer(index);
  const int result = device_->ioctl(VIDIOC_QBUF, &buffer);
  return result < 0 ? failed("takes no buffer back", -result) : "";
}

std::string VideoStream::start() {
  for (uint32_t i = 0; i < buffers_.size(); ++i)
    if (std::string problem = queue(i); !problem.empty()) return problem;
  int type = kBufType;
  if (const int result = device_->ioctl(VIDIOC_STREAMON, &type); result < 0)
    return failed("does not start to stream", -result);
  started_ = true;
  return {};
}

VideoStream::Read VideoStream::read(int timeout_ms, StreamFrame* frame, std::string* error) {
  if (!device_->system().poll(device_->fd(), timeout_ms)) return Read::kNothing;
  v4l2_buffer buffer = empty_buffer();
  if (const int result = device_->ioctl(VIDIOC_DQBUF, &buffer); result < 0) {
    if (result == -EAGAIN) return Read::kNothing;
    *error = failed("gives no image", -result);
    return Read::kFailed;
  }
  if (buffer.index >= buffers_.size()) {
    *error = fmt::format("{}: gives buffer {} of {}", device_->path(), buffer.index, buffers_.size());
    return Read::kFailed;
  }
  held_ = buffer.index;
  const Mapping& memory = buffers_[buffer.index];
  const size_t used = std::min<size_t>(buffer.bytesused, memory.length);
  frame->image = {{static_cast<const uint8_t*>(memory.start), used}, format_.width, format_.height, format_.stride};
  frame->sequence = buffer.sequence;
  frame->damaged = buffer.flags & V4L2_BUF_FLAG_ERROR;
  frame->stamps.stamp_us = microseconds(buffer.timestamp);
  // Drivers that name no clock (v4l2loopback) use the monotonic clock, or the system clock, whose times are too far off
  // to be mistaken for monotonic ones.
  frame->stamps.monotonic = (buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) != V4L2_BUF_FLAG_TIMESTAMP_COPY;
  frame->stamps.start_of_exposure = (buffer.flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
  frame->stamps.now = device_->system().now();
  return Read::kFrame;
}

std::string VideoStream::release() {
  const std::optional<uint32_t> held = held_;
  held_.reset();
  return held ? queue(*held) : "";
}

OpenedStream open_stream(std::unique_ptr<VideoDevice> device, const StreamRequest& request) {
  std::unique_ptr<VideoStream> stream(new VideoStream(std::move(device)));
  OpenedStream opened;
  opened.error = stream->choose_format(request);
  if (opened.error.empty()) {
    stream->set_rate(request.rate_hz);
    opened.error = stream->map_buffers();
  }
  opened.busy = stream->busy();
  if (opened.error.empty()) opened.stream = std::move(stream);
  return opened;
}

}  // namespace rumi::camera_driver
