// SPDX-License-Identifier: BSD-3-Clause
// A back submap in the language of the front ones: ORB keypoints of the same extractor, matched along the epipolar
// lines of the finished poses. So the same image has the same keypoints in both, and front_tracker can relocalize here.
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
  ImageMask mask = {};  // no keypoints are made where it leaves something out
};

// One keyframe per image of the model, ids 0, 1, ... in order of time, each also a frame; landmarks with at least
// two observations. The unit of length is the median depth of the model's points. images by the model's image index,
// in order of time.
void fill_back_submap(const Camera& camera, const std::vector<SeenImage>& images, const SparseModel& model,
                      Submap* submap);

}  // namespace rumi::ruminator
