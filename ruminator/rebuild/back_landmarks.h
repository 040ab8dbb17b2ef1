// SPDX-License-Identifier: BSD-3-Clause
// Fills a back submap with ORB keypoints of front_tracker's extractor, matched along the epipolar lines given by the
// final poses. Therefore an image has the same keypoints in front and back submaps, and front_tracker can relocalize in
// both.
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "ruminator/colmap/read_model.h"
#include "slam/features/image_mask.h"
#include "slam/features/orb_extractor.h"
#include "slam/map/submap.h"

namespace rumi::ruminator {

struct SeenImage {
  int64_t utime_us = 0;
  cv::Mat grey;
  ImageMask mask = {};  // no keypoints in the masked part
};

// Adds a keyframe and a frame for each image of the model, with ids 0, 1, ... in order of time, and landmarks with at
// least two observations. The submap's unit is the median depth of the model's points. `images`: by the model's image
// index, in order of time.
void fill_back_submap(const Camera& camera, const std::vector<SeenImage>& images, const SparseModel& model,
                      Submap* submap);

}  // namespace rumi::ruminator
