// SPDX-License-Identifier: BSD-3-Clause
// Opens V4L2 capture devices and reads what they offer.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "camera_driver/v4l2/video_system.h"

namespace rumi::camera_driver {

// An open device; closed with the object.
class VideoDevice {
 public:
  VideoDevice(VideoSystem& system, int fd, std::string path) : system_(&system), fd_(fd), path_(std::move(path)) {}
  ~VideoDevice();
  VideoDevice(const VideoDevice&) = delete;
  VideoDevice& operator=(const VideoDevice&) = delete;

  VideoSystem& system() const { return *system_; }
  int fd() const { return fd_; }
  const std::string& path() const { return path_; }
  // Returns 0, or -errno.
  template <class T>
  int ioctl(unsigned long request, T* argument) const {
    return system_->ioctl(fd_, request, argument);
  }

 private:
  VideoSystem* system_;
  int fd_;
  std::string path_;
};

struct CameraIdentity {
  std::string card, driver, bus;  // "HD Webcam", "uvcvideo", "usb-0000:00:14.0-1"
  bool operator==(const CameraIdentity&) const = default;
};

struct OpenedDevice {
  std::unique_ptr<VideoDevice> device;
  CameraIdentity identity;
  std::string error;  // names the device, the fault and what to do; empty: no fault
  bool is_camera = false;
  bool busy = false;  // another program uses the device, but may release it
};
OpenedDevice open_video_device(VideoSystem& system, const std::string& path);

// Image sizes that are offered, in pixels: one, or a range in steps.
struct SizeRange {
  int width = 0, height = 0;
  int max_width = 0, max_height = 0, step_width = 1, step_height = 1;
  bool contains(int w, int h) const;
  std::string to_string() const;
};
struct RateRange {
  double min_hz = 0, max_hz = 0;
};

// Return what the device offers; empty if it does not say. The lists have a limited length, whatever the device says.
std::vector<uint32_t> pixel_formats_of(const VideoDevice& device);
std::vector<SizeRange> sizes_of(const VideoDevice& device, uint32_t fourcc);
std::vector<RateRange> rates_of(const VideoDevice& device, uint32_t fourcc, int width, int height);
// Returns the offered rate that is nearest to the wanted one; the wanted one if the device offers no rates.
double nearest_rate(const std::vector<RateRange>& rates, double wanted_hz);

// True if the input names a camera and not a recording: "/dev/video0", "/dev/v4l/by-id/...", "camera:NAME".
bool names_camera(const std::string& input);
struct FoundDevice {
  std::string path, error;
};
// Finds the device file of an input that names_camera() accepts. "camera:NAME" is looked up by (a part of) the camera's
// name or its name in /dev/v4l/by-id, and must be unambiguous.
FoundDevice find_camera_device(VideoSystem& system, const std::string& input);

// Describes the cameras with their formats, sizes, rates and controls, for a person.
std::string list_cameras(VideoSystem& system);

}  // namespace rumi::camera_driver
