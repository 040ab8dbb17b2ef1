// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/v4l2/video_device.h"

#include <fmt/format.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>

namespace rumi::camera_driver {
namespace {

// Entries read of each list, at most: a broken driver must not keep us for ever.
constexpr uint32_t kMostFormats = 256, kMostSizes = 256, kMostRates = 256;

template <size_t N>
std::string text(const __u8 (&field)[N]) {
  const char* begin = reinterpret_cast<const char*>(field);
  std::string out(begin, strnlen(begin, N));
  for (char& c : out)
    if (static_cast<unsigned char>(c) < ' ' || c == 0x7F) c = '?';
  return out;
}

std::string why_not_opened(VideoSystem& system, const std::string& path, int error) {
  const std::string devices = fmt::format("{}", fmt::join(system.devices(), ", "));
  switch (error) {
    case ENOENT:
    case ENODEV:
    case ENXIO:
      return fmt::format("{}: there is no such camera; there {}{}. Is it plugged in? (`rumi camera_driver --list`)",
                         path, devices.empty() ? "is none at all" : "are ", devices);
    case EACCES:
    case EPERM:
      return fmt::format(
          "{}: no permission; it belongs to the group '{}': run  sudo usermod -aG {} $USER  and log in again", path,
          system.group_of(path), system.group_of(path));
    case EBUSY:
      return fmt::format("{}: is in use by another program (fuser -v {} tells which)", path, path);
    default:
      return fmt::format("{}: cannot be opened: {}", path, std::strerror(error));
  }
}

double hz(const v4l2_fract& interval) {
  return interval.numerator > 0 ? static_cast<double>(interval.denominator) / interval.numerator : 0;
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

}  // namespace

VideoDevice::~VideoDevice() { system_->close(fd_); }

OpenedDevice open_video_device(VideoSystem& system, const std::string& path) {
  OpenedDevice opened;
  const int fd = system.open(path);
  if (fd < 0) {
    opened.error = why_not_opened(system, path, -fd);
    opened.busy = fd == -EBUSY;
    return opened;
  }
  auto device = std::make_unique<VideoDevice>(system, fd, path);
  v4l2_capability capability{};
  if (const int result = device->ioctl(VIDIOC_QUERYCAP, &capability); result < 0) {
    opened.error = fmt::format("{}: is not a camera (VIDIOC_QUERYCAP: {})", path, std::strerror(-result));
    return opened;
  }
  opened.identity = {text(capability.card), text(capability.driver), text(capability.bus_info)};
  const uint32_t can =
      capability.capabilities & V4L2_CAP_DEVICE_CAPS ? capability.device_caps : capability.capabilities;
  if (can & V4L2_CAP_VIDEO_CAPTURE_MPLANE)
    opened.error =
        fmt::format("{}: '{}' has only the multi-planar interface, which is not supported", path, opened.identity.card);
  else if (!(can & V4L2_CAP_VIDEO_CAPTURE))
    opened.error = fmt::format(
        "{}: '{}' gives no images (a camera may have several devices; `rumi camera_driver --list` shows those that do)",
        path, opened.identity.card);
  else if (!(can & V4L2_CAP_STREAMING))
    opened.error = fmt::format("{}: '{}' cannot stream into memory, which is needed", path, opened.identity.card);
  opened.is_camera = opened.error.empty();
  if (opened.is_camera) opened.device = std::move(device);
  return opened;
}

bool SizeRange::contains(int w, int h) const {
  return w >= width && w <= max_width && h >= height && h <= max_height && (w - width) % step_width == 0 &&
         (h - height) % step_height == 0;
}

std::string SizeRange::to_string() const {
  if (width == max_width && height == max_height) return fmt::format("{} x {}", width, height);
  return fmt::format("{} x {} to {} x {}", width, height, max_width, max_height);
}

std::vector<uint32_t> pixel_formats_of(const VideoDevice& device) {
  std::vector<uint32_t> formats;
  v4l2_fmtdesc entry{};
  entry.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  for (entry.index = 0; entry.index < kMostFormats && device.ioctl(VIDIOC_ENUM_FMT, &entry) == 0; ++entry.index)
    formats.push_back(entry.pixelformat);
  return formats;
}

std::vector<SizeRange> sizes_of(const VideoDevice& device, uint32_t fourcc) {
  std::vector<SizeRange> sizes;
  v4l2_frmsizeenum entry{};
  entry.pixel_format = fourcc;
  for (entry.index = 0; entry.index < kMostSizes && device.ioctl(VIDIOC_ENUM_FRAMESIZES, &entry) == 0; ++entry.index) {
    const auto number = [](uint32_t n) { return static_cast<int>(std::min<uint32_t>(n, INT32_MAX)); };
    if (entry.type == V4L2_FRMSIZE_TYPE_DISCRETE) {
      const int width = number(entry.discrete.width), height = number(entry.discrete.height);
      sizes.push_back({width, height, width, height, 1, 1});
      continue;
    }
    const v4l2_frmsize_stepwise& range = entry.stepwise;
    sizes.push_back({number(range.min_width), number(range.min_height), number(range.max_width),
                     number(range.max_height), std::max(1, number(range.step_width)),
                     std::max(1, number(range.step_height))});
    break;  // a range is the only entry
  }
  return sizes;
}

std::vector<RateRange> rates_of(const VideoDevice& device, uint32_t fourcc, int width, int height) {
  std::vector<RateRange> rates;
  v4l2_frmivalenum entry{};
  entry.pixel_format = fourcc;
  entry.width = static_cast<uint32_t>(width);
  entry.height = static_cast<uint32_t>(height);
  for (entry.index = 0; entry.index < kMostRates && device.ioctl(VIDIOC_ENUM_FRAMEINTERVALS, &entry) == 0;
       ++entry.index) {
    if (entry.type == V4L2_FRMIVAL_TYPE_DISCRETE) {
      rates.push_back({hz(entry.discrete), hz(entry.discrete)});
      continue;
    }
    rates.push_back({hz(entry.stepwise.max), hz(entry.stepwise.min)});
    break;
  }
  return rates;
}

double nearest_rate(const std::vector<RateRange>& rates, double wanted_hz) {
  double best = rates.empty() ? wanted_hz : 0;
  for (const RateRange& rate : rates) {
    const double near = std::clamp(wanted_hz, rate.min_hz, std::max(rate.min_hz, rate.max_hz));
    if (std::abs(near - wanted_hz) < std::abs(best - wanted_hz)) best = near;
  }
  return best;
}

bool names_camera(const std::string& input) {
  return input.starts_with("/dev/video") || input.starts_with("/dev/v4l/") || input.starts_with("camera:");
}

FoundDevice find_camera_device(VideoSystem& system, const std::string& input) {
  if (!input.starts_with("camera:")) return {input, ""};
  const std::string wanted = lower(input.substr(7));
  std::vector<std::string> found, others;
  for (const std::string& path : system.devices()) {
    const OpenedDevice opened = open_video_device(system, path);
    if (!opened.is_camera) continue;
    bool fits = lower(opened.identity.card).find(wanted) != std::string::npos;
    for (const std::string& name : system.lasting_names(path)) fits |= lower(name).find(wanted) != std::string::npos;
    const std::string described = fmt::format("{} '{}'", path, opened.identity.card);
    (fits ? found : others).push_back(fits ? path : described);
  }
  if (found.size() == 1) return {found[0], ""};
  if (found.empty())
    return {"", fmt::format("{}: no camera has this name; there {}{}", input,
                            others.empty() ? "is none that can be opened" : "are ", fmt::join(others, ", "))};
  return {"", fmt::format("{}: is the name of several: {}; give one of these, or its name in /dev/v4l/by-id", input,
                          fmt::join(found, ", "))};
}

}  // namespace rumi::camera_driver
