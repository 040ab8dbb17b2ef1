// SPDX-License-Identifier: BSD-3-Clause
// Packs many small pictures into a few large ones.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace rumi::synth {

class TextureAtlas {
 public:
  static constexpr int kSize = 4096;      // width and height of a layer, pixels
  static constexpr int kMaxPatch = 4000;  // width or height of a picture, at most, pixels

  struct Patch {
    int layer = 0;
    cv::Rect px;
  };
  // Adds a picture (CV_8UC2). Its edge is repeated around it, so that smaller mipmap levels do not mix in its
  // neighbours.
  Patch add(const cv::Mat& picture);
  // Adds a picture (CV_8UC2) of a whole layer, which can be repeated.
  Patch add_layer(const cv::Mat& picture);
  // Hands the layers over, after which nothing can be added.
  std::vector<cv::Mat> take_layers() { return std::move(layers_); }
  const std::vector<cv::Mat>& layers() const { return layers_; }

 private:
  struct Shelf {
    int layer, y, height, used;
  };
  Shelf* find_shelf(cv::Size size);
  std::vector<cv::Mat> layers_;
  std::vector<int> filled_;  // by layer: number of rows that belong to shelves
  std::vector<Shelf> shelves_;
};

}  // namespace rumi::synth
