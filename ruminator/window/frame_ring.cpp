// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/window/frame_ring.h"

#include <iterator>
#include <utility>

#include "bus/wire/image_codec.h"
#include "bus/wire/image_stream.h"
#include "bus/wire/jpeg_image.h"

namespace rumi::ruminator {
namespace {

int64_t size_of(const image_t& image) {
  int64_t bytes = static_cast<int64_t>(sizeof(image_t) + image.data.size());
  for (const image_metadata_t& m : image.metadata) bytes += static_cast<int64_t>(m.key.size() + m.value.size());
  return bytes;
}

bool is_plausible(const image_t& image) {
  const bool known =
      image.pixelformat == image_t::PIXEL_FORMAT_GRAY || image.pixelformat == image_t::PIXEL_FORMAT_RGB ||
      image.pixelformat == image_t::PIXEL_FORMAT_MJPEG || image.pixelformat == image_t::PIXEL_FORMAT_YUYV;
  return known && image.width > 0 && image.height > 0 && !image.data.empty();
}

}  // namespace

bool FrameRing::fits(const image_t& image) const { return bytes_ + size_of(image) <= max_bytes_; }

bool FrameRing::add(const image_t& image) {
  if (!is_plausible(image)) {
    ++broken_;
    return false;
  }
  const ImageId id{image.utime, stream_of(image)};
  if (frames_.contains(id)) return true;
  if (!fits(image)) {
    ++dropped_;
    return false;
  }
  bytes_ += size_of(image);
  frames_.emplace(id, Entry{image, arrivals_++, false});
  return true;
}

FrameRing::Frames::const_iterator FrameRing::look_up(const ImageId& image) const {
  const auto named = frames_.find(image);
  return named != frames_.end() ? named : frames_.find({image.utime_us, kNoStream});
}

const image_t* FrameRing::find(const ImageId& image) const {
  const auto it = look_up(image);
  return it == frames_.end() ? nullptr : &it->second.image;
}

FrameRing::Frames::iterator FrameRing::erase(Frames::iterator it) {
  bytes_ -= size_of(it->second.image);
  return frames_.erase(it);
}

void FrameRing::settle(const ImageId& image, const Needed& needed) {
  const auto settled = look_up(image);
  if (settled == frames_.end()) return sweep(needed);
  const int64_t newest = settled->second.arrival;
  for (auto it = frames_.begin(); it != frames_.end();) {
    Entry& entry = it->second;
    entry.is_settled = entry.is_settled || entry.arrival <= newest;
    const bool goes = entry.is_settled && (!needed(it->first) || (entry.arrival < newest && !compress(entry)));
    it = goes ? erase(it) : std::next(it);
  }
}

void FrameRing::sweep(const Needed& needed) {
  for (auto it = frames_.begin(); it != frames_.end();)
    it = it->second.is_settled && !needed(it->first) ? erase(it) : std::next(it);
}

void FrameRing::limit_unsettled(int count) {
  std::map<int64_t, Frames::iterator> unsettled;  // unsettled images, by arrival
  for (auto it = frames_.begin(); it != frames_.end(); ++it)
    if (!it->second.is_settled) unsettled.emplace(it->second.arrival, it);
  while (static_cast<int>(unsettled.size()) > count) {
    erase(unsettled.begin()->second);
    unsettled.erase(unsettled.begin());
    ++dropped_;
  }
}

bool FrameRing::compress(Entry& entry) {
  image_t& image = entry.image;
  if (image.pixelformat == image_t::PIXEL_FORMAT_MJPEG) return true;
  const bool is_grey = image.pixelformat == image_t::PIXEL_FORMAT_GRAY;
  const Result<cv::Mat> pixels = is_grey ? decode_grey(image) : decode_bgr(image);
  if (!pixels) {
    ++broken_;
    return false;
  }
  const int64_t size_before = size_of(image);
  image_t jpeg = make_jpeg_image(image.utime, *pixels, jpeg_quality_);
  jpeg.nmetadata = image.nmetadata;
  jpeg.metadata = std::move(image.metadata);
  bytes_ += size_of(jpeg) - size_before;
  image = std::move(jpeg);
  return true;
}

}  // namespace rumi::ruminator
