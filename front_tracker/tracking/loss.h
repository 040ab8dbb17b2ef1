// SPDX-License-Identifier: BSD-3-Clause
// What became of a loss of track, in one line for whoever looks on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace rumi::front_tracker {

struct Loss {
  int64_t first_utime_us = 0;  // of the recording: times are told since then
  int64_t utime_us = 0;        // of the first image that was lost
  int submap_id = 0;           // that it was lost in
  size_t frames_before = 0;    // that this submap had then
  std::string why = {};        // the first image was
  int images = 0;              // lost so far
  int posed_afterwards = 0;    // of these
  int withdrawn = 0;           // images before it whose poses turned out to be wrong
  std::string outcome = {};    // "found again in submap 1"

  // A single image, or one that was found again at once: nothing was lost that anybody would miss.
  bool is_hiccup() const { return images <= 1 && withdrawn == 0; }
};

// utime_us: of the image that ended it, or of the last one.
std::string describe(const Loss& loss, int64_t utime_us);

// Tells of each loss in one line, when it is over.
class LossReport {
 public:
  void begin(Loss loss) { loss_ = std::move(loss); }
  // Is something lost, or was it until the present image?
  bool is_open() const { return loss_.has_value(); }
  double seconds_until(int64_t utime_us) const { return 1e-6 * static_cast<double>(utime_us - loss_->utime_us); }

  // What the present image brings, if something was lost.
  void set_outcome(std::string outcome);
  // After each image; how many frames before it got their poses by it, and how many lost theirs.
  void image(int64_t utime_us, bool has_pose, size_t posed_afterwards, size_t withdrawn);
  // No more images come.
  void end(int64_t last_utime_us);

 private:
  std::optional<Loss> loss_;  // while it is not over
};

}  // namespace rumi::front_tracker
