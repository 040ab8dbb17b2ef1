// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include "camera_driver/v4l2/pixel_format.h"
#include "camera_driver/v4l2/video_controls.h"
#include "camera_driver/v4l2/video_device.h"

namespace rumi::camera_driver {
namespace {

std::string list_rates(const VideoDevice& device, uint32_t fourcc, const SizeRange& size) {
  std::string text;
  for (const RateRange& rate : rates_of(device, fourcc, size.width, size.height)) {
    text += text.empty() ? "" : ", ";
    text += rate.min_hz < rate.max_hz ? fmt::format("{:.4g} to {:.4g}", rate.min_hz, rate.max_hz)
                                      : fmt::format("{:.4g}", rate.max_hz);
  }
  return text.empty() ? "" : ": " + text + " Hz";
}

std::string list_formats(const VideoDevice& device) {
  std::string text, unknown;
  for (const uint32_t fourcc : pixel_formats_of(device)) {
    const PixelFormat* format = find_pixel_format(fourcc);
    if (!format) {
      unknown += (unknown.empty() ? "" : " ") + fourcc_text(fourcc);
      continue;
    }
    text += fmt::format("  {} ({})\n", format->option, fourcc_text(fourcc));
    for (const SizeRange& size : sizes_of(device, fourcc))
      text += fmt::format("    {}{}\n", size.to_string(), list_rates(device, fourcc, size));
  }
  if (!unknown.empty()) text += fmt::format("  formats that Rumi does not understand: {}\n", unknown);
  return text;
}

std::string list_controls(const VideoDevice& device) {
  std::string text;
  for (const VideoControl& control : controls_of(device)) {
    if (!control.settable) continue;
    const std::optional<int32_t> value = read_control(device, control.id);
    text += fmt::format("    {:<32} {} .. {}, step {}, default {}{}\n", control.name, control.min, control.max,
                        control.step, control.preset, value ? fmt::format(", now {}", *value) : "");
    for (const auto& [index, name] : control.menu) text += fmt::format("      {}: {}\n", index, name);
  }
  return text.empty() ? "" : "  controls:\n" + text;
}

}  // namespace

std::string list_cameras(VideoSystem& system) {
  std::string text;
  for (const std::string& path : system.devices()) {
    const OpenedDevice opened = open_video_device(system, path);
    if (!opened.is_camera) {
      text += opened.error + "\n";
      continue;
    }
    text += fmt::format("{}  '{}' ({}, {})\n", path, opened.identity.card, opened.identity.driver, opened.identity.bus);
    for (const std::string& name : system.lasting_names(path)) text += fmt::format("  also {}\n", name);
    text += list_formats(*opened.device) + list_controls(*opened.device);
  }
  return text.empty() ? "no camera: there is no /dev/video*\n" : text;
}

}  // namespace rumi::camera_driver
