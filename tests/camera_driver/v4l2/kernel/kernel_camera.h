// SPDX-License-Identifier: BSD-3-Clause
// Controls the kernel's virtual camera (vivid) from its other side: what it shows, what it does wrong, when it is
// there.
#pragma once

#include <gtest/gtest.h>
#include <linux/videodev2.h>
#include <unistd.h>

#include <fstream>
#include <string>

#include "camera_driver/v4l2/video_controls.h"
#include "camera_driver/v4l2/video_device.h"

namespace rumi::testing {

using namespace camera_driver;

inline constexpr const char* kDevice = "/dev/video0";
inline constexpr int kWidth = 320, kHeight = 180;

class KernelCamera {
 public:
  // Sets a control of vivid by name, through a file descriptor of its own.
  static void set(const std::string& name, int32_t value) {
    const OpenedDevice opened = open_video_device(kernel_video_system(), kDevice);
    ASSERT_EQ(opened.error, "");
    for (const VideoControl& control : controls_of(*opened.device)) {
      if (control.name != name) continue;
      v4l2_control request{control.id, value};
      ASSERT_EQ(opened.device->ioctl(VIDIOC_S_CTRL, &request), 0) << name;
      return;
    }
    FAIL() << "vivid has no " << name;
  }
  static int32_t get(const std::string& name) {
    const OpenedDevice opened = open_video_device(kernel_video_system(), kDevice);
    if (!opened.device) return -1;
    for (const VideoControl& control : controls_of(*opened.device))
      if (control.name == name) return read_control(*opened.device, control.id).value_or(-1);
    return -1;
  }
  static void press(const std::string& button) { set(button, 1); }
  // Do as if the camera was pulled out and put in again.
  static void unplug() { std::ofstream("/sys/bus/platform/drivers/vivid/unbind") << "vivid.0\n"; }
  static void plug_in() { std::ofstream("/sys/bus/platform/drivers/vivid/bind") << "vivid.0\n"; }
  static bool is_there() { return access(kDevice, F_OK) == 0; }

  // Returns a frame as another program (v4l2-ctl) gets it; empty if that fails.
  static std::vector<uint8_t> reference_frame(const std::string& fourcc) {
    const std::string file = "/run/reference.raw";
    const std::string command = "v4l2-ctl -d " + std::string(kDevice) +
                                " --set-fmt-video=width=" + std::to_string(kWidth) +
                                ",height=" + std::to_string(kHeight) + ",pixelformat=" + fourcc +
                                " --stream-mmap=3 --stream-count=1 --stream-to=" + file + " >/dev/null 2>&1";
    if (std::system(command.c_str()) != 0) return {};
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
};

}  // namespace rumi::testing
