// SPDX-License-Identifier: BSD-3-Clause
// A V4L2 device that does what a test tells it. Its clock moves only when somebody waits.
#pragma once

#include <linux/videodev2.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <deque>
#include <functional>
#include <map>
#include <set>

#include "camera_driver/v4l2/video_system.h"

namespace rumi::testing {
using namespace rumi::camera_driver;

// A result of VIDIOC_DQBUF: a frame or an error.
struct FakeFrame {
  std::vector<uint8_t> data;
  uint32_t sequence = 0;
  int64_t stamp_us = 0;
  uint32_t flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
  int error = 0;             // errno that comes instead of the frame; 0: no error
  int64_t arrives_us = 0;    // the frame does not come before this time; 0: at once
  uint32_t wrong_index = 0;  // number of a buffer that does not exist, to be given instead; 0: the right one
};

struct FakeControl {
  std::string name;
  int32_t min = 0, max = 1, value = 0;
  uint32_t type = V4L2_CTRL_TYPE_INTEGER;
  uint32_t flags = 0;
  std::vector<int32_t> menu = {};  // values that can be chosen
};

class FakeCamera : public VideoSystem {
 public:
  struct Format {
    uint32_t fourcc;
    std::vector<std::pair<uint32_t, uint32_t>> sizes;
    uint32_t rate_hz;
  };
  // Properties of the device.
  std::string path = "/dev/video0", card = "Fake Webcam";
  uint32_t capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
  std::vector<Format> formats = {{V4L2_PIX_FMT_GREY, {{64, 48}}, 30}};
  std::map<uint32_t, FakeControl> controls;
  // Behaviour of the device.
  std::deque<FakeFrame> frames;
  int open_error = 0;
  std::map<unsigned long, int> errors;                                // errno by request
  std::function<void(unsigned long request, void* argument)> tamper;  // after a request that went well
  uint32_t buffer_bytes = 64 * 48 * 3;
  Clocks clocks{1'000'000'000, 1'700'000'000'000'000};
  // Records of how the device was used.
  int open_count = 0, mapped_count = 0, opened_times = 0;
  bool streaming = false;
  std::set<uint32_t> queued;
  std::vector<std::pair<std::string, int32_t>> set_controls;
  int64_t waited_us = 0;

  int64_t offset_us() const { return clocks.system_us - clocks.monotonic_us; }
  void advance(int64_t us) { clocks.monotonic_us += us, clocks.system_us += us, waited_us += us; }
  // Adds frames 1/30 s apart. The first one is stamped now, and each arrives 10 ms after its stamp.
  void add_frames(int n, uint32_t sequence, const std::vector<uint8_t>& data) {
    for (int i = 0; i < n; ++i) {
      FakeFrame frame{data, sequence + static_cast<uint32_t>(i), clocks.monotonic_us + i * 33'333};
      frame.arrives_us = frame.stamp_us + 10'000;
      frames.push_back(frame);
    }
  }

  int open(const std::string& wanted) override {
    ++opened_times;
    if (wanted != path) return -ENOENT;
    if (open_error) return -open_error;
    ++open_count;
    return 7;
  }
  void close(int) override {
    --open_count;
    streaming = false;
    queued.clear();
  }
  void* map(int, size_t length, int64_t offset) override {
    const auto index = static_cast<size_t>(offset);
    if (memory_.size() <= index) memory_.resize(index + 1);
    memory_[index].assign(length, 0);
    ++mapped_count;
    return memory_[index].data();
  }
  void unmap(void*, size_t) override { --mapped_count; }
  bool poll(int, int timeout_ms) override {
    const int64_t until = clocks.monotonic_us + timeout_ms * 1000;
    if (!frames.empty() && frames.front().arrives_us <= until) {
      advance(std::max<int64_t>(0, frames.front().arrives_us - clocks.monotonic_us));
      return true;
    }
    advance(until - clocks.monotonic_us);
    return false;
  }
  void wait(int ms) override { advance(ms * 1000); }
  Clocks now() override { return clocks; }
  std::vector<std::string> devices() override { return {path}; }
  std::vector<std::string> lasting_names(const std::string&) override { return {"/dev/v4l/by-id/usb-Fake-0042"}; }
  std::string group_of(const std::string&) override { return "video"; }

  int ioctl(int, unsigned long request, void* argument) override {
    if (const auto it = errors.find(request); it != errors.end()) return -it->second;
    const int result = answer(request, argument);
    if (result == 0 && tamper) tamper(request, argument);
    return result;
  }

 private:
  const Format* find(uint32_t fourcc) const {
    for (const Format& format : formats)
      if (format.fourcc == fourcc) return &format;
    return nullptr;
  }
  template <size_t N>
  static void put(__u8 (&field)[N], const std::string& text) {
    std::memcpy(field, text.c_str(), std::min(N, text.size() + 1));
  }
  int answer(unsigned long request, void* argument) {
    switch (request) {
      case VIDIOC_QUERYCAP: {
        auto* a = static_cast<v4l2_capability*>(argument);
        put(a->card, card);
        put(a->driver, "fake");
        put(a->bus_info, "usb-1");
        a->capabilities = capabilities | V4L2_CAP_DEVICE_CAPS;
        a->device_caps = capabilities;
        return 0;
      }
      case VIDIOC_ENUM_FMT: {
        auto* a = static_cast<v4l2_fmtdesc*>(argument);
        if (a->index >= formats.size()) return -EINVAL;
        a->pixelformat = formats[a->index].fourcc;
        return 0;
      }
      case VIDIOC_ENUM_FRAMESIZES: {
        auto* a = static_cast<v4l2_frmsizeenum*>(argument);
        const Format* format = find(a->pixel_format);
        if (!format || a->index >= format->sizes.size()) return -EINVAL;
        a->type = V4L2_FRMSIZE_TYPE_DISCRETE;
        a->discrete.width = format->sizes[a->index].first;
        a->discrete.height = format->sizes[a->index].second;
        return 0;
      }
      case VIDIOC_ENUM_FRAMEINTERVALS: {
        auto* a = static_cast<v4l2_frmivalenum*>(argument);
        if (a->index > 0) return -EINVAL;
        a->type = V4L2_FRMIVAL_TYPE_DISCRETE;
        a->discrete = {1, find(a->pixel_format)->rate_hz};
        return 0;
      }
      case VIDIOC_S_FMT: {
        auto* a = static_cast<v4l2_format*>(argument);
        fourcc_ = a->fmt.pix.pixelformat;
        a->fmt.pix.bytesperline = a->fmt.pix.width * (fourcc_ == V4L2_PIX_FMT_YUYV ? 2 : 1);
        a->fmt.pix.sizeimage = buffer_bytes;
        return 0;
      }
      case VIDIOC_S_PARM: {
        auto* a = static_cast<v4l2_streamparm*>(argument);
        a->parm.capture.timeperframe = {1, find(fourcc_)->rate_hz};
        return 0;
      }
      case VIDIOC_REQBUFS:
        return 0;
      case VIDIOC_QUERYBUF: {
        auto* a = static_cast<v4l2_buffer*>(argument);
        a->length = buffer_bytes;
        a->m.offset = a->index;
        return 0;
      }
      case VIDIOC_QBUF:
        queued.insert(static_cast<v4l2_buffer*>(argument)->index);
        return 0;
      case VIDIOC_STREAMON:
        streaming = true;
        return 0;
      case VIDIOC_STREAMOFF:
        streaming = false;
        return 0;
      case VIDIOC_DQBUF:
        return dequeue(static_cast<v4l2_buffer*>(argument));
      default:
        return control(request, argument);
    }
  }
  int dequeue(v4l2_buffer* a) {
    if (!streaming || frames.empty() || queued.empty()) return -EAGAIN;
    const FakeFrame frame = frames.front();
    frames.pop_front();
    if (frame.error) return -frame.error;
    a->index = *queued.begin();
    queued.erase(a->index);
    const size_t n = std::min(frame.data.size(), memory_[a->index].size());
    std::copy_n(frame.data.begin(), n, memory_[a->index].begin());
    a->bytesused = static_cast<uint32_t>(frame.data.size());
    a->sequence = frame.sequence;
    a->flags = frame.flags;
    a->timestamp = {frame.stamp_us / 1'000'000, frame.stamp_us % 1'000'000};
    if (frame.wrong_index) a->index = frame.wrong_index;
    return 0;
  }
  int control(unsigned long request, void* argument) {
    if (request == VIDIOC_QUERYCTRL) {
      auto* a = static_cast<v4l2_queryctrl*>(argument);
      const auto it = controls.upper_bound(a->id & ~V4L2_CTRL_FLAG_NEXT_CTRL);
      if (it == controls.end()) return -EINVAL;
      a->id = it->first;
      a->type = it->second.type;
      put(a->name, it->second.name);
      a->minimum = it->second.min;
      a->maximum = it->second.max;
      a->flags = it->second.flags;
      return 0;
    }
    if (request == VIDIOC_QUERYMENU) {
      const auto* a = static_cast<v4l2_querymenu*>(argument);
      const std::vector<int32_t>& menu = controls.at(a->id).menu;
      return std::find(menu.begin(), menu.end(), static_cast<int32_t>(a->index)) == menu.end() ? -EINVAL : 0;
    }
    auto* a = static_cast<v4l2_control*>(argument);
    const auto it = controls.find(a->id);
    if (it == controls.end()) return -EINVAL;
    if (request == VIDIOC_G_CTRL) a->value = it->second.value;
    if (request == VIDIOC_S_CTRL) {
      it->second.value = a->value;
      set_controls.emplace_back(it->second.name, a->value);
    }
    return request == VIDIOC_G_CTRL || request == VIDIOC_S_CTRL ? 0 : -ENOTTY;
  }

  uint32_t fourcc_ = 0;
  std::vector<std::vector<uint8_t>> memory_;
};

}  // namespace rumi::testing
