// SPDX-License-Identifier: BSD-3-Clause
// A recording, frame by frame, as it is stored: no selection, no new times, no checks. Frames that are only passed over
// are not loaded.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lcmtypes/rumi/image_t.hpp"

namespace rumi::camera_driver {

struct FrameStamp {
  int64_t utime_us = 0;  // as recorded
  std::string where;     // for messages: "…/rgb.txt:12"
};

struct Malformed {
  int64_t count = 0;
  std::string first;  // "…/rgb.txt:7: time is 'x': must be decimal seconds"
};

class FrameReader {
 public:
  virtual ~FrameReader() = default;

  // Steps to the next frame (the first one at first); nothing at the end.
  virtual std::optional<FrameStamp> advance() = 0;
  // The present frame: JPEG as stored, other files decoded: RGB if they have colour and `colour` is wanted, else grey.
  // Nothing, and why in *error, if it cannot be read.
  virtual std::optional<image_t> load(bool colour, std::string* error) = 0;
  // Before the first frame again.
  virtual void rewind() = 0;
  // The times of all frames where they are known beforehand, else empty.
  virtual std::vector<int64_t> utimes() const { return {}; }
  // Entries met so far that are no frames: broken lines, broken messages.
  virtual Malformed malformed() const { return {}; }
};

// An image file as `FrameReader::load` gives it.
std::optional<image_t> load_image_file(const std::filesystem::path& file, bool colour, std::string* error);

// A recording that was opened, or what is wrong with it.
struct OpenedReader {
  std::unique_ptr<FrameReader> reader;
  std::string error;  // empty, or file, what is wrong, and what to do
};

// Times are those of the container.
OpenedReader open_video(const std::filesystem::path& file);
// image_t messages on one channel.
OpenedReader open_log(const std::filesystem::path& file, const std::string& channel);

}  // namespace rumi::camera_driver
