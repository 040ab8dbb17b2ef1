// SPDX-License-Identifier: BSD-3-Clause
// Reports each loss of track in one line of the log.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace rumi::front_tracker {

struct Loss {
  int64_t first_utime_us = 0;  // beginning of the recording; times are counted from there
  int64_t utime_us = 0;        // time of the first image that was lost
  int submap_id = 0;           // in which the camera was lost
  size_t frames_before = 0;    // number of frames that this submap had then
  std::string why = {};        // why the first image was lost
  int images = 0;              // number of images lost so far
  int posed_afterwards = 0;    // how many of these got a pose since
  int withdrawn = 0;           // images before the loss whose poses turned out to be wrong
  std::string outcome = {};    // "found again in submap 1"

  // True if at most one image was lost and no pose was withdrawn: not worth a line for the user.
  bool is_hiccup() const { return images <= 1 && withdrawn == 0; }
};

// `utime_us`: time of the image that ended the loss, or of the last image.
std::string describe(const Loss& loss, int64_t utime_us);

// Logs each loss in one line when it is over.
class LossReport {
 public:
  void begin(Loss loss) { loss_ = std::move(loss); }
  // True if the camera is lost, or was until the present image.
  bool is_open() const { return loss_.has_value(); }
  double seconds_until(int64_t utime_us) const { return 1e-6 * static_cast<double>(utime_us - loss_->utime_us); }

  // Says what the present image brings, if the camera was lost.
  void set_outcome(std::string outcome);
  // Call it after each image. `posed_afterwards`, `withdrawn`: how many earlier frames got or lost their poses by it.
  void image(int64_t utime_us, bool has_pose, size_t posed_afterwards, size_t withdrawn);
  // No more images come.
  void end(int64_t last_utime_us);

 private:
  std::optional<Loss> loss_;  // the loss that is not over
};

}  // namespace rumi::front_tracker
