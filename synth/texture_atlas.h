// SPDX-License-Identifier: BSD-3-Clause
// Many small pictures packed into a few large ones.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace rumi::synth {

class TextureAtlas {
 public:
  static constexpr int kSize = 4096;      // pixels, width and height of a layer
  static constexpr int kMaxPatch = 4000;  // pixels, width or height of a picture

  struct Patch {
    int layer = 0;
    cv::Rect px;
  };
  // CV_8UC2; its edge is repeated around it so that smaller mipmap levels do not mix in the neighbours.
  Patch add(const cv::Mat& picture);
  const std::vector<cv::Mat>& layers() const { return layers_; }

 private:
  struct Shelf {
    int layer, y, height, used;
  };
  Shelf* find_shelf(cv::Size size);
  std::vector<cv::Mat> layers_;
  std::vector<int> filled_;  // rows given to shelves, by layer
  std::vector<Shelf> shelves_;
};

}  // namespace rumi::synth
