// SPDX-License-Identifier: BSD-3-Clause
// Writes the images of a recording.
#pragma once

#include <string>

#include "lcmtypes/rumi/image_t.hpp"

namespace rumi::tool {

class ImageSink {
 public:
  virtual ~ImageSink() = default;  // what was not closed does not remain
  // False if it has failed, and needs no more images; close() says why.
  virtual bool write(const image_t& image) = 0;
  // Ends the file. Returns an empty string, or an error, and then no file is left.
  virtual std::string close() = 0;
  // The content of the file, to be put after the number of images: "images on CAMERA". Call it after close().
  virtual std::string content() const = 0;
};

}  // namespace rumi::tool
