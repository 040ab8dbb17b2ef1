// SPDX-License-Identifier: BSD-3-Clause
// The interface of a file into which the images of a recording are written.
#pragma once

#include <string>

#include "lcmtypes/rumi/image_t.hpp"

namespace rumi::tool {

class ImageSink {
 public:
  virtual ~ImageSink() = default;  // removes a file that was not closed
  // Returns false after a failure; then no more images need to be written. close() says why.
  virtual bool write(const image_t& image) = 0;
  // Ends the file. Returns an empty string, or an error; after an error no file is left.
  virtual std::string close() = 0;
  // Says what the file contains, to be put after the number of images: "images on CAMERA". Call it after close().
  virtual std::string content() const = 0;
};

}  // namespace rumi::tool
