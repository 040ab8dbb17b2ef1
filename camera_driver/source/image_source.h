// SPDX-License-Identifier: BSD-3-Clause
// One interface for all sources of images, recordings and cameras.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/result.h"
#include "camera_driver/source/camera_options.h"
#include "lcmtypes/rumi/image_t.hpp"
#include "slam/geometry/camera.h"

namespace rumi::camera_driver {

// Counts frames that are not handed out, by reason, and those that front_tracker leaves out.
struct SkippedFrames {
  int64_t malformed = 0;     // lines or messages that cannot be read as a frame
  int64_t duplicate = 0;     // time equal to that of another frame
  int64_t out_of_order = 0;  // recording: time far from those around; camera: time before that of the last frame
  int64_t unreadable = 0;    // the file is missing, or the data are corrupt
  int64_t wrong_size = 0;    // another size than the calibration's
  int64_t other_camera = 0;  // from another camera or stream on the same channel
  int64_t lost = 0;          // camera: images missing in the driver's numbering
  int64_t repeated = 0;      // the same image as the one before, in a long run of such images
  int64_t longest_row = 0;   // length of the longest run of repeated images
  double longest_row_s = 0;  // beginning of that run, since the first image
  int64_t total() const {
    return malformed + duplicate + out_of_order + unreadable + wrong_size + other_camera + lost + repeated;
  }
  std::string to_string() const;  // "2 duplicate times, 1 unreadable", or empty
  // Returns a sentence, with what to do, for each reason for which more than 1 % of all images were skipped.
  // `handed_out`: number of images that were not skipped.
  std::vector<std::string> complaints(int64_t handed_out) const;
};

// Says that images of this size can hardly be tracked; empty if they can.
std::string too_few_pixels(int width, int height);

// The state of a camera while it runs.
struct LiveState {
  std::string problem;  // why there are no images now, and what to do; empty while there are
  double rate_hz = 0;   // measured rate; 0: not measured yet
  bool ended = false;   // the camera has ended, after options.duration_s
};

class ImageSource {
 public:
  virtual ~ImageSource() = default;

  // Returns the next image, ready to publish: encoded, of the camera's size, with the calibration in its metadata. Its
  // utime is above the last one, unless a recording's clock was set back (FrameOrder). Returns nullopt at the end.
  // Skipped images are counted; the first of a kind and the totals at the end are logged.
  virtual std::optional<image_t> next() = 0;
  virtual const Camera& camera() const = 0;
  // Returns what the user gave as input, for messages.
  virtual const std::string& name() const = 0;
  // Returns the number of images to hand out, including those that will turn out unreadable; -1: unknown or endless.
  virtual int64_t total() const = 0;
  virtual const SkippedFrames& skipped() const = 0;
  // Returns the state of a camera, nullptr for a recording. A camera's next() waits for an image for some 20 ms; if it
  // returns nullopt there is no image yet, unless `ended` is set. Its utime is when the image was taken, on the system
  // clock.
  virtual const LiveState* live() const { return nullptr; }
  // Makes a recording hand out the images of these times once more: in colour if they have any, or as they were handed
  // out before. Skipped images are no longer counted or logged.
  enum class Pixels { kColour, kAsBefore };
  virtual void play_again(const std::set<int64_t>& /*utimes_us*/, Pixels /*pixels*/) {}
  // True if play_again() with few images costs little. A video must be decoded from its beginning.
  virtual bool plays_few_quickly() const { return true; }
  // Return the file of the image that was handed out last, and the deepest folder that contains all images of the
  // recording; empty if images have no files.
  virtual std::filesystem::path file_of_last() const { return {}; }
  virtual std::filesystem::path image_folder() const { return {}; }
  // Sets a camera's controls.
  virtual void set_controls(const CameraControls& /*controls*/) {}
};

// Errors name the input, what is wrong, and what to do.
using OpenedSource = Result<std::unique_ptr<ImageSource>>;

}  // namespace rumi::camera_driver
