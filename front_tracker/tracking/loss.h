// SPDX-License-Identifier: BSD-3-Clause
// A loss of track: what one line of the log says about it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace rumi::front_tracker {

struct Loss {
  int64_t first_utime_us = 0;  // beginning of the recording, from which times are counted
  int64_t utime_us = 0;        // time of the first image that was lost
  int submap_id = 0;           // submap in which the camera was lost
  size_t frames_before = 0;    // frames that this submap had then
  std::string why = {};        // why the first image was lost
  int images = 0;              // images lost so far
  int posed_afterwards = 0;    // how many of these have got a pose since
  int withdrawn = 0;           // images before the loss whose poses turned out to be wrong
  std::string outcome = {};    // "found again in submap 1"

  // True if at most one image was lost and no pose was withdrawn: that is not worth a line for the user.
  bool is_hiccup() const { return images <= 1 && withdrawn == 0; }
};

// Returns a line on the loss for the log. `utime_us`: time of the image that ended the loss, or of the last image.
std::string describe(const Loss& loss, int64_t utime_us);

// Logs each loss in one line when it is over.
class LossReport {
 public:
  void begin(Loss loss) { loss_ = std::move(loss); }
  // True while the camera is lost, and at the image with which it is found again.
  bool is_open() const { return loss_.has_value(); }
  double seconds_until(int64_t utime_us) const { return 1e-6 * static_cast<double>(utime_us - loss_->utime_us); }

  // Says what happened at the present image, if the camera was lost.
  void set_outcome(std::string outcome);
  // To be called after each image. `posed_afterwards` earlier frames got their poses with it, and `withdrawn` earlier
  // frames lost theirs.
  void image(int64_t utime_us, bool has_pose, size_t posed_afterwards, size_t withdrawn);
  // To be called when no more images come.
  void end(int64_t last_utime_us);

 private:
  std::optional<Loss> loss_;  // present loss; nullopt if there is none
};

}  // namespace rumi::front_tracker
