// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/window/learned_masks.h"

#include <algorithm>
#include <opencv2/core.hpp>
#include <string>
#include <tuple>

#include "bus/wire/image_codec.h"
#include "bus/wire/image_masks.h"
#include "slam/features/image_mask.h"
#include "slam/geometry/max_side.h"

namespace rumi::ruminator {
namespace {

constexpr size_t kMostStreams = 8;

bool is_plausible(const mask_t& message) {
  const auto is_side = [](int side) { return side > 0 && side <= kMaxSide; };
  return message.stream > 0 && message.session > 0 && message.utime >= 0 && is_side(message.width) &&
         is_side(message.height);
}

bool is_readable(const mask_t& message, const std::string& png) {
  return size_of_mask(png) == cv::Size(message.width, message.height) && decode_mask(png);
}

// Joins two masks: the result masks what either masks. Empty if nothing is masked.
std::string join(const ImageMask& own, const ImageMask& learned) {
  const ImageMask joint = own.and_also(learned);
  return joint.is_everything() ? "" : encode_mask(joint.pixels());
}

}  // namespace

bool LearnedMasks::take(const mask_t& message) {
  if (!is_plausible(message)) return false;
  const std::string png(message.png.begin(), message.png.end());
  const auto known = masks_.find(message.stream);
  const bool is_new = known == masks_.end() || known->second.png != png;
  if (is_new && !png.empty() && !is_readable(message, png)) return false;
  Learned learned{message.session, message.utime, png};
  const auto age = [](const Learned& one) { return std::tuple(one.session, one.utime_us); };
  if (known != masks_.end() && age(learned) < age(known->second)) return true;  // an older mask came late
  masks_[message.stream] = std::move(learned);
  forget_oldest();
  return true;
}

void LearnedMasks::forget_oldest() {
  if (masks_.size() <= kMostStreams) return;
  masks_.erase(std::min_element(masks_.begin(), masks_.end(),
                                [](const auto& a, const auto& b) { return a.second.session < b.second.session; }));
}

void LearnedMasks::put_on(std::vector<image_t>* images, int64_t stream) const {
  const auto known = masks_.find(stream);
  if (known == masks_.end() || known->second.png.empty()) return;
  const ImageMask learned(decode_mask(known->second.png).value_or(cv::Mat()));
  MaskReader reader;
  std::string own, joint;  // successive images mostly have the same mask
  cv::Size size;
  for (image_t& image : *images) {
    const cv::Size its_size(image.width, image.height);
    if (const std::string its(metadata(image, kMaskKey)); its != own || its_size != size) {
      joint = join(reader.read(image, its_size), learned.resized(its_size));
      own = its;
      size = its_size;
    }
    if (!joint.empty()) set_metadata(&image, kMaskKey, joint);
  }
}

}  // namespace rumi::ruminator
