// SPDX-License-Identifier: BSD-3-Clause
// Decodes JPEG strictly and silently. For broken data cv::imdecode prints to stderr and returns images whose lower part
// is grey; a tracker must know that they are broken.
#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <span>

#include "base/result.h"

namespace rumi {

struct JpegSize {
  int width = 0, height = 0;  // pixels
  size_t bytes = 0;           // bytes up to and including the end marker: some cameras leave something behind it
};

// Reads the size from the frame header, without decoding. An Error if this is no JPEG, its header is broken or missing,
// or it is truncated (no end marker).
Result<JpegSize> inspect_jpeg(std::span<const uint8_t> data);

// Decodes to 8-bit grey or BGR. An orientation noted in the file is not applied: it would turn the image away from its
// calibration. With a `reduction` of 2, 4 or 8 both sides of the image are divided by it (rounded up), which is much
// faster. An Error also where libjpeg could go on with guessed pixels.
Result<cv::Mat> decode_jpeg(std::span<const uint8_t> data, bool grey, int reduction = 1);

}  // namespace rumi
