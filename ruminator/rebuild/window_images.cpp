// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/rebuild/window_images.h"

#include <fmt/format.h>

#include <utility>

#include "bus/wire/working_image.h"
#include "slam/features/lens_mask.h"

namespace rumi::ruminator {

WindowImages::WindowImages(const WindowJob& job, const Camera& camera, int sift_keypoints)
    : job_(job),
      camera_(camera),
      sift_keypoints_(sift_keypoints),
      masks_(lens_mask(camera)),
      images_(job.images.size()) {}

const SiftFeatures* WindowImages::features(size_t index) {
  Slot& slot = images_[index];
  if (!slot.is_decoded) slot.image = decode(job_.images[index]);
  slot.is_decoded = true;
  return slot.image ? &slot.image->features : nullptr;
}

std::unique_ptr<WindowImages::Image> WindowImages::decode(const image_t& image) {
  ++decoded_;
  Result<cv::Mat> grey = decode_working_image(image, job_.camera, camera_);
  if (!grey) return nullptr;                                 // a broken image is left out
  const ImageMask& mask = masks_.read(image, grey->size());  // if its mask is broken, nothing is masked
  auto decoded = std::make_unique<Image>();
  decoded->features = extract_sift(*grey, camera_, sift_keypoints_, mask);
  decoded->seen = {image.utime, std::move(*grey), mask};
  return decoded;
}

UsableImages WindowImages::take() {
  UsableImages usable;
  for (const Slot& slot : images_) {
    if (!slot.image) continue;
    const int64_t utime_us = slot.image->seen.utime_us;
    usable.utimes_us.push_back(utime_us);
    usable.colmap.push_back({fmt::format("{}", utime_us), slot.image->features.undistorted});
    usable.features.push_back(std::move(slot.image->features));
    usable.seen.push_back(std::move(slot.image->seen));
  }
  images_.clear();
  return usable;
}

}  // namespace rumi::ruminator
