// SPDX-License-Identifier: BSD-3-Clause
// Where images come from: one interface, whatever the recording or the camera.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "camera_driver/source/camera_options.h"
#include "lcmtypes/rumi/image_t.hpp"
#include "slam/geometry/camera.h"

namespace rumi::camera_driver {

// Frames that are not handed out, by reason; and those that front_tracker leaves out.
struct SkippedFrames {
  int64_t malformed = 0;     // lines or messages that are no frame
  int64_t duplicate = 0;     // time equal to that of another frame
  int64_t out_of_order = 0;  // recording: time far from those around; camera: before that of the frame before
  int64_t unreadable = 0;    // missing or corrupt
  int64_t wrong_size = 0;    // not that of the calibration
  int64_t other_camera = 0;  // of another camera or stream on the same channel, in turn
  int64_t lost = 0;          // camera: gaps in the driver's numbering
  int64_t repeated = 0;      // the same image as the one before, in a row that is not short
  int64_t longest_row = 0;   // of such images
  double longest_row_s = 0;  // where it begins, since the first image
  int64_t total() const {
    return malformed + duplicate + out_of_order + unreadable + wrong_size + other_camera + lost + repeated;
  }
  std::string to_string() const;  // "2 duplicate times, 1 unreadable", or empty
  // Of a recording of which `handed_out` images were not skipped: a sentence for each reason for which more than 1 % of
  // all were, with what to do.
  std::vector<std::string> complaints(int64_t handed_out) const;
};

// Empty, or that images of this size can hardly be tracked.
std::string too_few_pixels(int width, int height);

// How a camera does.
struct LiveState {
  std::string problem;  // why there are no images now, and what to do; empty: there are
  double rate_hz = 0;   // measured; 0: not yet
  bool ended = false;   // after options.duration_s
};

class ImageSource {
 public:
  virtual ~ImageSource() = default;

  // The next image, ready to publish: utime rising strictly, encoded, of the camera's size, with the calibration in its
  // metadata. Nothing at the end. What is skipped is counted; the first of a kind and the totals at the end are logged.
  virtual std::optional<image_t> next() = 0;
  virtual const Camera& camera() const = 0;
  // The input, for messages.
  virtual const std::string& name() const = 0;
  // How many images there are to hand out, those that will turn out unreadable included; -1: unknown or endless.
  virtual int64_t total() const = 0;
  virtual const SkippedFrames& skipped() const = 0;
  // Null for a recording. For a camera next() waits for an image for some 20 ms, and nothing means that there is none
  // yet, unless it has ended; utime is when the image was taken, on the system clock.
  virtual const LiveState* live() const { return nullptr; }
  // A recording hands out its images once more, from the beginning: those of these times only, in colour where they
  // have any, or as they were handed out before. Nothing more is counted or logged of what is skipped.
  enum class Pixels { kColour, kAsBefore };
  virtual void play_again(const std::set<int64_t>& /*utimes_us*/, Pixels /*pixels*/) {}
  // Whether playing few images again costs little: a video is decoded from its beginning on.
  virtual bool plays_few_quickly() const { return true; }
  // The file of the image that was handed out last, and the deepest folder that has all images of the recording; empty
  // where images have no files.
  virtual std::filesystem::path file_of_last() const { return {}; }
  virtual std::filesystem::path image_folder() const { return {}; }
  // A camera's controls are from now on these.
  virtual void set_controls(const CameraControls& /*controls*/) {}
};

struct OpenedSource {
  std::unique_ptr<ImageSource> source;
  std::string error;  // empty, or file, what is wrong, and what to do
  bool ok() const { return source != nullptr; }
};

}  // namespace rumi::camera_driver
