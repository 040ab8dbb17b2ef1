// SPDX-License-Identifier: BSD-3-Clause
// Reads a recording as it is stored: no selection, no new times, no checks.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <opencv2/core/types.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
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

  // Returns the recorded time of each frame, in stored order. All are 0 if the frames have no times.
  virtual const std::vector<int64_t>& utimes() const = 0;
  // Says why the frames have no times; empty if they have.
  virtual std::string why_no_times() const { return {}; }
  // Says why the calibration beside the images cannot be used; empty if it can, or if there is none.
  virtual std::string why_no_calibration() const { return {}; }
  // Returns the frame's place, for messages: "…/rgb.txt:12".
  virtual std::string where(size_t frame) const = 0;
  // Return the image's own file, and the folder to which the names of images are relative; empty if frames have no
  // files.
  virtual std::filesystem::path file(size_t /*frame*/) const { return {}; }
  virtual std::filesystem::path folder() const { return {}; }
  // Loads a JPEG as it is stored, and decodes other images: to RGB if they have colour and `colour` is true, else to
  // grey. Loading is quickest in rising order. Errors say where() and why the image cannot be read.
  virtual Result<image_t> load(size_t frame, bool colour) = 0;
  // False if a frame can be loaded only by decoding those before it.
  virtual bool loads_any_frame_alone() const { return true; }
  // Counts the entries that are no frames: broken lines, broken messages.
  virtual Malformed malformed() const { return {}; }
  // Returns the number of images of other cameras, which are left out.
  virtual int64_t of_other_cameras() const { return 0; }
  // Returns the number of images that the recording's own header or list promises and that are missing, mostly at the
  // end.
  virtual int64_t missing_at_end() const { return 0; }
  // Returns when the last image was recorded, by the recorder's clock; nullopt if it is not known.
  virtual std::optional<int64_t> last_recorded_us() const { return std::nullopt; }
  // Returns lines that tell the user how the recording is read.
  virtual std::vector<std::string> notes() const { return {}; }
};

// Errors name the file, what is wrong, and what to do.
using OpenedReader = Result<std::unique_ptr<FrameReader>>;

// Opens a video. Its times are those of the container, in the order of showing. `grey_range`: for pixels of 16 bits; if
// it is not given, the reader measures the range of the recording when it meets the first such image. If there are
// several streams, one whose images have a `wanted` size is preferred.
OpenedReader open_video(const std::filesystem::path& file, std::optional<GreyRange> grey_range,
                        const std::vector<cv::Size>& wanted);
// Plays the image_t messages on one channel.
OpenedReader open_log(const std::filesystem::path& file, const std::string& channel);
// Plays a log in several files.
OpenedReader open_log_parts(const std::vector<std::filesystem::path>& files, const std::string& channel);
// Plays the images on a topic of a ROS bag (a file or a folder). With the default of log_channel it plays the only
// topic with images.
OpenedReader open_bag(const std::filesystem::path& path, const std::string& channel,
                      std::optional<GreyRange> grey_range);

}  // namespace rumi
