// SPDX-License-Identifier: BSD-3-Clause
// A mask tells which part of an image shows the world. It travels with the image: a PNG of the image's size in its
// metadata, black where something else is seen (COLMAP's convention).
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <string_view>
#include <utility>

#include "base/result.h"
#include "lcmtypes/rumi/image_t.hpp"
#include "slam/features/image_mask.h"

namespace rumi {

inline constexpr const char* kMaskKey = "mask";

// Returns the bytes of a PNG with two colours: 0 stays black, everything else becomes white.
std::string encode_mask(const cv::Mat& pixels);
// Returns the size that a PNG's header gives, read from its first kMaskHeaderBytes; empty if this is no PNG.
cv::Size size_of_mask(std::string_view bytes);
inline constexpr size_t kMaskHeaderBytes = 24;
// Returns an image that is 255 where the world is seen, else 0. In a PNG of several channels a pixel is left out if all
// are black; opacity is not looked at. An Error if the bytes are no PNG, or unpack to too much.
Result<cv::Mat> decode_mask(std::string_view bytes);

// Takes the masks out of images. Consecutive images mostly carry the same mask: it is decoded once.
class MaskReader {
 public:
  // `always`: pixels that it leaves out are left out of every image. It may have another size than the images.
  explicit MaskReader(ImageMask always = {}) : always_(std::move(always)) {}

  // Returns the image's mask joined with `always`, resized to `size`. A mask that cannot be used counts as missing: see
  // problem().
  const ImageMask& read(const image_t& image, const cv::Size& size);
  // Says why the mask of the last image that was read cannot be used; empty if it can, or the image has none.
  const std::string& problem() const { return problem_; }

 private:
  ImageMask always_;
  std::string bytes_, problem_;
  cv::Size size_;
  ImageMask mask_;
};

}  // namespace rumi
