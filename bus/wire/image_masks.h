// SPDX-License-Identifier: BSD-3-Clause
// What of an image shows the world, as it travels with the image: a PNG of its size in the metadata, black where
// something else is seen (COLMAP's convention).
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <string_view>
#include <utility>

#include "lcmtypes/rumi/image_t.hpp"
#include "slam/features/image_mask.h"

namespace rumi {

inline constexpr const char* kMaskKey = "mask";

// Black and white, losslessly: 0 stays 0, all else becomes white. The bytes of a PNG.
std::string encode_mask(const cv::Mat& pixels);
// What the header of a PNG says; nothing if it is none.
cv::Size size_of_mask(std::string_view bytes);
inline constexpr size_t kMaskHeaderBytes = 24;  // so many tell it
// A PNG's bytes; of several channels a pixel is left out if it is black, and opacity counts for nothing. 255 is the
// world. Empty, and in *error what is wrong, if they are none.
cv::Mat decode_mask(const std::string& bytes, std::string* error);

// Takes the masks out of images. Images in a row mostly have the same one: it is decoded once.
class MaskReader {
 public:
  // `always`: a mask of all images besides, which may have another size.
  explicit MaskReader(ImageMask always = {}) : always_(std::move(always)) {}

  // As large as `size`. In *error what is wrong with the image's mask, which counts for nothing then.
  const ImageMask& read(const image_t& image, const cv::Size& size, std::string* error);

 private:
  ImageMask always_;
  std::string bytes_, error_;
  cv::Size size_;
  ImageMask mask_;
};

}  // namespace rumi
