// SPDX-License-Identifier: BSD-3-Clause
// The images of a window at their working size, with masks and SIFT keypoints. A rebuild needs them several times
// (first look, matching, the back submap's keypoints), but each image is decoded only once, and its SIFT keypoints are
// found only once. All grey images stay in memory: some hundred, of at most 0.9 MB each at the default working size.
//
// (Before a window is known, ImageMotion decodes every image too, at a fraction of its size.)
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "bus/wire/image_masks.h"
#include "ruminator/matching/sift_features.h"
#include "ruminator/matching/window_image.h"
#include "ruminator/rebuild/back_landmarks.h"
#include "ruminator/window/window_job.h"

namespace rumi::ruminator {

// The usable images, in order of time; all vectors have the same length.
struct UsableImages {
  std::vector<SeenImage> seen;
  std::vector<int64_t> utimes_us;
  std::vector<SiftFeatures> features;
  std::vector<WindowImage> colmap;
};

class WindowImages {
 public:
  // `camera`: the working camera. The job must outlive this object.
  WindowImages(const WindowJob& job, const Camera& camera, int sift_keypoints);

  size_t size() const { return images_.size(); }  // number of the job's images
  // Returns the keypoints of the job's image `index`, computed at the first call. Null if the image is broken, or from
  // another camera.
  const SiftFeatures* features(size_t index);
  int decoded() const { return decoded_; }  // images decoded so far, broken ones included

  // Moves out all usable images for which features() was called.
  UsableImages take();

 private:
  struct Image {
    SeenImage seen;
    SiftFeatures features;
  };
  struct Slot {
    bool is_decoded = false;
    std::unique_ptr<Image> image;
  };
  std::unique_ptr<Image> decode(const image_t& image);

  const WindowJob& job_;
  Camera camera_;
  int sift_keypoints_;
  MaskReader masks_;
  std::vector<Slot> images_;  // by index in the job
  int decoded_ = 0;
};

}  // namespace rumi::ruminator
