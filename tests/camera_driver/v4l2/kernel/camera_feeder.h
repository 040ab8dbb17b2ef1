// SPDX-License-Identifier: BSD-3-Clause
// Plays the part of a program, such as OBS or ffmpeg, that feeds v4l2loopback's virtual camera. The camera exists while
// the object lives, and shows the images that are given to write().
#pragma once

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <vector>

namespace rumi::testing {

inline constexpr const char* kFedDevice = "/dev/video8";

class CameraFeeder {
 public:
  // Throws std::runtime_error if the device cannot be opened with this format.
  CameraFeeder(uint32_t fourcc, int width, int height, uint32_t rate_hz) : fd_(::open(kFedDevice, O_RDWR | O_CLOEXEC)) {
    if (fd_ < 0) fail("open");
    v4l2_format format{};
    format.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
    format.fmt.pix.width = static_cast<uint32_t>(width);
    format.fmt.pix.height = static_cast<uint32_t>(height);
    format.fmt.pix.pixelformat = fourcc;
    format.fmt.pix.field = V4L2_FIELD_NONE;
    if (::ioctl(fd_, VIDIOC_S_FMT, &format) < 0) fail("VIDIOC_S_FMT");
    if (format.fmt.pix.pixelformat != fourcc) fail("another format");
    v4l2_streamparm parameters{};
    parameters.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
    parameters.parm.output.timeperframe = {1, rate_hz};
    if (::ioctl(fd_, VIDIOC_S_PARM, &parameters) < 0) fail("VIDIOC_S_PARM");
    int type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
    if (::ioctl(fd_, VIDIOC_STREAMON, &type) < 0) fail("VIDIOC_STREAMON");
  }
  ~CameraFeeder() { ::close(fd_); }
  CameraFeeder(const CameraFeeder&) = delete;
  CameraFeeder& operator=(const CameraFeeder&) = delete;

  void write(const std::vector<uint8_t>& frame) {
    if (::write(fd_, frame.data(), frame.size()) != static_cast<ssize_t>(frame.size())) fail("write");
  }

 private:
  [[noreturn]] static void fail(const char* what) {
    throw std::runtime_error(fmt::format("{}: {}: {}", kFedDevice, what, std::strerror(errno)));
  }
  int fd_;
};

}  // namespace rumi::testing
