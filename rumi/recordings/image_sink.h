// SPDX-License-Identifier: BSD-3-Clause
// Where the images of a recording go.
#pragma once

#include <string>

#include "lcmtypes/rumi/image_t.hpp"

namespace rumi::tool {

class ImageSink {
 public:
  virtual ~ImageSink() = default;  // what was not closed does not remain
  // False if it has failed, and more need not come: close() tells why.
  virtual bool write(const image_t& image) = 0;
  // Empty, or what is wrong; then nothing remains of the file.
  virtual std::string close() = 0;
  // What was written, behind the number of images: "images on CAMERA". After close().
  virtual std::string content() const = 0;
};

}  // namespace rumi::tool
