// SPDX-License-Identifier: BSD-3-Clause
// The images that a window may need, bounded in bytes. Every image waits here for its tracking state. After that it
// stays as long as a sample refers to it.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>

#include "lcmtypes/rumi/image_t.hpp"
#include "slam/map/image_id.h"

namespace rumi::ruminator {

class FrameRing {
 public:
  using Needed = std::function<bool(const ImageId& image)>;

  FrameRing(int64_t max_bytes, int jpeg_quality) : max_bytes_(max_bytes), jpeg_quality_(jpeg_quality) {}

  // Adds an image as it came. Returns false and counts it as dropped if it does not fit, or as broken if it is no image
  // (sizes, format). An image that is here already stays as it is.
  bool add(const image_t& image);
  bool fits(const image_t& image) const;
  // Finds the image of this stream, or else one of this time whose stream is not named.
  const image_t* find(const ImageId& image) const;

  // Call it when the state of this image is known: removes it and those before it unless they are needed. Compresses
  // those that stay and came uncompressed, except the newest, which mostly is not needed a frame later.
  void settle(const ImageId& image, const Needed& needed);
  // Removes all settled images that are not needed.
  void sweep(const Needed& needed);
  // Of the images that are not settled, keeps the newest `count`, removes the others and counts them as dropped.
  void limit_unsettled(int count);

  int64_t bytes() const { return bytes_; }
  int size() const { return static_cast<int>(frames_.size()); }
  int64_t dropped() const { return dropped_; }  // so far, for lack of room
  int64_t broken() const { return broken_; }    // so far: no images, or raw ones that cannot be compressed

 private:
  struct Entry {
    image_t image;
    int64_t arrival = 0;
    bool is_settled = false;
  };
  using Frames = std::map<ImageId, Entry>;
  Frames::const_iterator look_up(const ImageId& image) const;
  Frames::iterator erase(Frames::iterator it);
  bool compress(Entry& entry);

  int64_t max_bytes_;
  int jpeg_quality_;
  Frames frames_;
  int64_t bytes_ = 0;
  int64_t arrivals_ = 0;
  int64_t dropped_ = 0, broken_ = 0;
};

}  // namespace rumi::ruminator
