// SPDX-License-Identifier: BSD-3-Clause
// A recording as it is stored: no selection, no new times, no checks.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <opencv2/core/types.hpp>
#include <optional>
#include <string>
#include <vector>

#include "formats/image/grey_range.h"
#include "lcmtypes/rumi/image_t.hpp"

namespace rumi {

struct Malformed {
  int64_t count = 0;
  std::string first;  // "…/rgb.txt:7: time is 'x': must be decimal seconds"
};

class FrameReader {
 public:
  virtual ~FrameReader() = default;

  // The time of each frame, as recorded, in the order in which they are stored. All 0 where there are none.
  virtual const std::vector<int64_t>& utimes() const = 0;
  // Empty, or why the frames have no times.
  virtual std::string why_no_times() const { return {}; }
  // Empty, or why the calibration that it has beside its images is none.
  virtual std::string why_no_calibration() const { return {}; }
  // For messages: "…/rgb.txt:12".
  virtual std::string where(size_t frame) const = 0;
  // The image's own file, and the folder that names of its images are relative to; empty where frames have no files.
  virtual std::filesystem::path file(size_t /*frame*/) const { return {}; }
  virtual std::filesystem::path folder() const { return {}; }
  // JPEG as stored, other files decoded: RGB if they have colour and `colour` is wanted, else grey. Quickest in rising
  // order. Nothing, and why in *error, if it cannot be read.
  virtual std::optional<image_t> load(size_t frame, bool colour, std::string* error) = 0;
  // False where a frame can be had only by decoding those before it.
  virtual bool loads_any_frame_alone() const { return true; }
  // Entries that are no frames: broken lines, broken messages.
  virtual Malformed malformed() const { return {}; }
  // Images of other cameras among those of the one that is played: no frames.
  virtual int64_t of_other_cameras() const { return 0; }
  // Images that the recording should have, by its own header or list, mostly at the end.
  virtual int64_t missing_at_end() const { return 0; }
  // When the last image was recorded, by the recorder's clock; nothing if it is not known.
  virtual std::optional<int64_t> last_recorded_us() const { return std::nullopt; }
  // What the user should know of how the recording is read, a line each.
  virtual std::vector<std::string> notes() const { return {}; }
};

// A recording that was opened, or what is wrong with it.
struct OpenedReader {
  std::unique_ptr<FrameReader> reader;
  std::string error;  // empty, or file, what is wrong, and what to do
};

// Times are those of the container, in the order of showing. `grey_range`: of pixels of 16 bits; without it that of the
// recording is measured when the first one is met. `wanted`: sizes of images, of which one is preferred where the file
// has several streams.
OpenedReader open_video(const std::filesystem::path& file, std::optional<GreyRange> grey_range,
                        const std::vector<cv::Size>& wanted);
// image_t messages on one channel.
OpenedReader open_log(const std::filesystem::path& file, const std::string& channel);
// The same of a log in parts.
OpenedReader open_log_parts(const std::vector<std::filesystem::path>& files, const std::string& channel);
// The images of a topic of a ROS bag, a file or a folder; with the default of log_channel of the one that has some.
OpenedReader open_bag(const std::filesystem::path& path, const std::string& channel,
                      std::optional<GreyRange> grey_range);

}  // namespace rumi
