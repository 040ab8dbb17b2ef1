// SPDX-License-Identifier: BSD-3-Clause
#include "synth/texture_atlas.h"

#include <opencv2/imgproc.hpp>

namespace rumi::synth {

TextureAtlas::Shelf* TextureAtlas::find_shelf(cv::Size size) {
  for (Shelf& shelf : shelves_)
    if (shelf.used + size.width <= kSize && size.height <= shelf.height && size.height * 5 > shelf.height * 4)
      return &shelf;
  for (int layer = 0;; ++layer) {
    if (layer == static_cast<int>(layers_.size())) {
      layers_.push_back(cv::Mat::zeros(kSize, kSize, CV_8UC2));
      filled_.push_back(0);
    }
    if (filled_[layer] + size.height > kSize) continue;
    shelves_.push_back({layer, filled_[layer], size.height, 0});
    filled_[layer] += size.height;
    return &shelves_.back();
  }
}

TextureAtlas::Patch TextureAtlas::add(const cv::Mat& picture) {
  const int gutter = std::min(picture.cols, picture.rows) > 300 ? 16 : 4;
  cv::Mat padded;
  cv::copyMakeBorder(picture, padded, gutter, gutter, gutter, gutter, cv::BORDER_REPLICATE);
  Shelf* shelf = find_shelf(padded.size());
  const cv::Rect where(shelf->used, shelf->y, padded.cols, padded.rows);
  padded.copyTo(layers_[shelf->layer](where));
  shelf->used += padded.cols;
  return {shelf->layer, {where.x + gutter, where.y + gutter, picture.cols, picture.rows}};
}

TextureAtlas::Patch TextureAtlas::add_layer(const cv::Mat& picture) {
  layers_.push_back(picture);
  filled_.push_back(kSize);
  return {static_cast<int>(layers_.size()) - 1, {0, 0, kSize, kSize}};
}

}  // namespace rumi::synth
