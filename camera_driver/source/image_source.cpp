// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/source/image_source.h"

#include <fmt/format.h>

#include <algorithm>

namespace rumi::camera_driver {

std::string SkippedFrames::to_string() const {
  std::string out;
  const auto add = [&out](int64_t count, const char* what) {
    if (count > 0) out += fmt::format("{}{} {}", out.empty() ? "" : ", ", count, what);
  };
  add(malformed, "malformed entries");
  add(duplicate, "duplicate times");
  add(out_of_order, "wrong times");
  add(unreadable, "unreadable images");
  add(wrong_size, "images of another size");
  add(other_camera, "images of other cameras");
  add(lost, "lost by the camera or its driver");
  add(repeated, "the same as the one before");
  return out;
}

std::string too_few_pixels(int width, int height) {
  constexpr int kLeast = 72;  // pixels of the shorter side; see docs/recordings.md
  if (std::min(width, height) >= kLeast) return {};
  return fmt::format("images of {} x {} pixels are too small to be tracked; 96 x 72 is the least, 320 x 240 good",
                     width, height);
}

std::vector<std::string> SkippedFrames::complaints(int64_t handed_out) const {
  constexpr double kTolerable = 0.01;
  const auto all = static_cast<double>(handed_out + total());
  std::vector<std::string> sentences;
  const auto add = [&](int64_t count, const char* what, const char* remedy) {
    const double part = static_cast<double>(count) / all;
    if (count == 0 || part <= kTolerable) return;
    sentences.push_back(
        fmt::format("{} of {:.0f} images ({:.3g} %) were left out, {}; {}", count, all, 100 * part, what, remedy));
  };
  add(malformed, "because their lines or messages are none", "mend the list, or record them again");
  add(duplicate, "because they have the time of another one", "--rate HZ makes new times");
  add(out_of_order, "because their times are far from those of the images around them",
      "mend the times, or let --rate HZ make new ones");
  add(unreadable, "because they are missing or cannot be read", "copy or record them again");
  add(wrong_size, "because they are not of the calibration's size",
      "play them by themselves (a folder of their own, or camera_driver.files), with a calibration of their size");
  add(other_camera, "because they are of another camera or stream on the same channel",
      "record each camera on a channel of its own");
  if (repeated > 0 && static_cast<double>(repeated) / all > kTolerable)
    sentences.push_back(fmt::format(
        "{} of {:.0f} images are the same as the one before them (the longest row: {} {} from {:.2f} s on): "
        "the camera or the recorder stood still; they have no pose",
        repeated, all, longest_row, longest_row == 1 ? "image" : "images", longest_row_s));
  return sentences;
}

}  // namespace rumi::camera_driver
