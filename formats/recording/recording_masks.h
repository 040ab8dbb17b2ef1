// SPDX-License-Identifier: BSD-3-Clause
// Masks of a recording's images: what of them does not show the world. One of all images, and one an image.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "formats/recording/frame_reader.h"

namespace rumi {

// Where they may be.
struct MaskPlaces {
  std::string given;                           // by the user: a file, a folder, or kNoMask; empty: the others count
  std::string of_calibration;                  // the file that the calibration names, or empty
  std::vector<std::filesystem::path> folders;  // may have a file mask.png, and a folder `masks`
};

// True for a file beside images that is no image of the recording: mask.png, and a.jpg.png where a.jpg is.
bool is_mask_name(const std::string& name, const std::vector<std::string>& beside);

class RecordingMasks {
 public:
  // Finds them, and reads of each as much as tells whether it fits images of `size`. Returns what is wrong with one, or
  // an empty string.
  std::string find(const MaskPlaces& places, const FrameReader& reader, const cv::Size& size);

  // For the frame's metadata; empty where all of it is the world. One that turns out broken is told once and not used.
  std::string png_of(size_t frame);
  // For the log; empty if there are none.
  const std::string& what() const { return what_; }

 private:
  std::string use_for_all(const std::string& file);
  std::string find_of_frames(const std::filesystem::path& folder, const FrameReader& reader);
  std::string check_of_frames();
  bool has_found() const;

  cv::Size size_;
  cv::Mat of_all_;  // pixels, or empty
  std::string png_of_all_;
  std::vector<std::filesystem::path> of_frames_;  // a file each, or empty
  std::string what_;
  bool is_problem_told_ = false;
};

}  // namespace rumi
