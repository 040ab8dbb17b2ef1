// SPDX-License-Identifier: BSD-3-Clause
// Finds the masks of a recording: the parts of its images that do not show the world. All images may share one mask,
// and each may have its own.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "base/result.h"
#include "formats/recording/frame_reader.h"

namespace rumi {

// The places where masks are looked for.
struct MaskPlaces {
  std::string given;                           // what the user gave: file, folder, or kNoMask; empty: the places below
  std::string of_calibration;                  // the file that the calibration names, or empty
  std::vector<std::filesystem::path> folders;  // folders that may have a file mask.png, and a folder `masks`
};

// True for a file beside images that is no image of the recording: mask.png, and a.jpg.png where a.jpg is.
bool is_mask_name(const std::string& name, const std::vector<std::string>& beside);

class RecordingMasks {
 public:
  // Finds the masks, and reads enough of each to tell whether it fits images of `size`. An Error if one does not, or if
  // the place that the user gave has none.
  Result<> find(const MaskPlaces& places, const FrameReader& reader, const cv::Size& size);

  // Returns the PNG for the frame's metadata; empty if the frame has no mask. If its own mask turns out broken, only
  // the mask of all images is used; the first such case is logged.
  std::string png_of(size_t frame);
  // Describes the masks for the log; empty if there are none.
  const std::string& what() const { return what_; }

 private:
  Result<> use_for_all(const std::string& file);
  std::string find_of_frames(const std::filesystem::path& folder, const FrameReader& reader);
  Result<> check_of_frames();
  bool has_found() const;

  cv::Size size_;
  cv::Mat of_all_;  // mask of all images; may be empty
  std::string png_of_all_;
  std::vector<std::filesystem::path> of_frames_;  // mask file of each frame; may be empty
  std::string what_;
  bool is_problem_told_ = false;
};

}  // namespace rumi
