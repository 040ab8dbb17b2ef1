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

// Keypoints keep this distance (pixels of the level) from the image's border: as far as the rotated pattern reaches.
inline constexpr int kOrbBorder_px = 19;

struct OrbOptions {
  int keypoints = 1000;  // wanted per image; an image may have fewer
  Pyramid pyramid;
  int fast_threshold = 7;  // least contrast of a corner, grey levels; a low one costs little because the grid keeps the
                           // strongest
  int cell_px = 24;        // side of a grid cell, at every level
};

class OrbExtractor {
 public:
  explicit OrbExtractor(const OrbOptions& options);
  // Makes the pyramid for extract(). `grey`: 8 bits, at least 64 x 64 pixels; the pyramid shares its pixels.
  ImagePyramid pyramid(const cv::Mat& grey, const ImageMask& mask = {}) const;
  // `keypoints`, if positive, replaces OrbOptions::keypoints. The keypoints' pixels are those of the full image. Pixels
  // that the pyramid's mask leaves out give no keypoints. Deterministic.
  Features extract(const ImagePyramid& pyramid, int keypoints = 0);
  Features extract(const cv::Mat& grey, int keypoints = 0) { return extract(pyramid(grey), keypoints); }

 private:
  std::vector<cv::KeyPoint> find_corners(const cv::Mat& image, int octave, int wanted);
  std::vector<cv::KeyPoint> detect(const ImagePyramid& pyramid, int octave, int wanted);
  OrbOptions options_;
  // By level: true if the last image had few clear corners. Then the next one probably has few, too, and is searched
  // for faint ones at once, which saves time and does not change the result.
  std::vector<bool> lacks_clear_;
  cv::Ptr<cv::ORB> describer_;
};

}  // namespace rumi
