// SPDX-License-Identifier: BSD-3-Clause
// Keeps the images that a window may need, up to a number of bytes. Every image waits here for its tracking state;
// afterwards it stays as long as a sample needs it.
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

  // Adds an image. Returns false if it does not fit (counted as dropped), or if its size or format is invalid (counted
  // as broken). If the image is here already, changes nothing.
  bool add(const image_t& image);
  bool fits(const image_t& image) const;
  // Returns the image of this stream and time, or else one of this time without a stream; null if there is neither.
  const image_t* find(const ImageId& image) const;

  // To be called when the tracking state of this image is known. Removes it and all that arrived before it, unless they
  // are needed. Compresses those that stay and came uncompressed, except the image itself, which is mostly not needed
  // any more one frame later.
  void settle(const ImageId& image, const Needed& needed);
  // Removes all settled images that are not needed.
  void sweep(const Needed& needed);
  // Keeps the settled images and the newest `count` others. Removes the rest and counts them as dropped.
  void limit_unsettled(int count);

  int64_t bytes() const { return bytes_; }
  int size() const { return static_cast<int>(frames_.size()); }
  int64_t dropped() const { return dropped_; }  // images dropped so far, for lack of room or of their states
  int64_t broken() const { return broken_; }  // images with invalid data so far, or raw ones that cannot be compressed

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
