// SPDX-License-Identifier: BSD-3-Clause
// The operating system as the V4L2 source needs it, so that tests can replace it by a device of their own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace rumi::camera_driver {

class VideoSystem {
 public:
  virtual ~VideoSystem() = default;

  // Returns a file descriptor, or -errno.
  virtual int open(const std::string& path) = 0;
  virtual void close(int fd) = 0;
  // Returns 0, or -errno. Never interrupted by a signal.
  virtual int ioctl(int fd, unsigned long request, void* argument) = 0;
  // Returns nullptr on failure.
  virtual void* map(int fd, size_t length, int64_t offset) = 0;
  virtual void unmap(void* start, size_t length) = 0;
  // Returns true if there is a frame or an error to dequeue, false when the time is over.
  virtual bool poll(int fd, int timeout_ms) = 0;
  virtual void wait(int ms) = 0;

  struct Clocks {
    int64_t monotonic_us = 0;  // CLOCK_MONOTONIC, the clock of the kernel's time stamps
    int64_t system_us = 0;     // CLOCK_REALTIME, the clock of all utimes
  };
  virtual Clocks now() = 0;

  // Returns those of "/dev/video0", "/dev/video1", ... that exist.
  virtual std::vector<std::string> devices() = 0;
  // Returns the names of a device that stay the same when it is plugged in again: /dev/v4l/by-id/...
  virtual std::vector<std::string> lasting_names(const std::string& device) = 0;
  // Returns the group that a file belongs to, or an empty string.
  virtual std::string group_of(const std::string& path) = 0;
};

// The operating system itself. The object has no state.
VideoSystem& kernel_video_system();

}  // namespace rumi::camera_driver
