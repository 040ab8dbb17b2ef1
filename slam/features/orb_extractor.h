// SPDX-License-Identifier: BSD-3-Clause
// Oriented FAST keypoints with rotated BRIEF descriptors (Rublee et al., "ORB", ICCV 2011) over an image pyramid,
// spread evenly over the image: the strongest corners of every grid cell rather than the strongest of all.
#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/features2d.hpp>
#include <vector>

#include "slam/features/features.h"
#include "slam/features/image_pyramid.h"
#include "slam/features/pyramid.h"

namespace rumi {

// Keypoints keep away from the border as far as the rotated pattern reaches, in pixels of the level.
inline constexpr int kOrbBorder_px = 19;

struct OrbOptions {
  int keypoints = 1000;  // wanted per image; fewer where the image has no more
  Pyramid pyramid;
  int fast_threshold = 7;  // grey levels; the grid keeps the strongest, so a low one costs little
  int cell_px = 24;        // side of a grid cell, at every level
};

class OrbExtractor {
 public:
  explicit OrbExtractor(const OrbOptions& options);
  // The pyramid that extract() looks at, of an 8-bit grey image no smaller than 64 x 64 pixels; shares its pixels.
  ImagePyramid pyramid(const cv::Mat& grey, const ImageMask& mask = {}) const;
  // `keypoints` overrides the wanted number if positive. Pixels are full-resolution ones. There are none where the
  // pyramid's mask leaves something out. Deterministic.
  Features extract(const ImagePyramid& pyramid, int keypoints = 0);
  Features extract(const cv::Mat& grey, int keypoints = 0) { return extract(pyramid(grey), keypoints); }

 private:
  std::vector<cv::KeyPoint> find_corners(const cv::Mat& image, int octave, int wanted);
  std::vector<cv::KeyPoint> detect(const ImagePyramid& pyramid, int octave, int wanted);
  OrbOptions options_;
  // Per level, of the last image: whether it had few clear corners. So will the next one, most likely; nothing but time
  // depends on it.
  std::vector<bool> lacks_clear_;
  cv::Ptr<cv::ORB> describer_;
};

}  // namespace rumi
