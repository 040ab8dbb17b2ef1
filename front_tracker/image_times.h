// SPDX-License-Identifier: BSD-3-Clause
// Judges whether an image's time goes on from that of the image before, also by the clock times of their arrival. For a
// recording, camera_driver checks all times beforehand; for a live camera, the next times are unknown.
#pragma once

#include <cstdint>
#include <string>

namespace rumi::front_tracker {

class ImageTimes {
 public:
  enum class Verdict {
    kNext,     // goes on from the last image that was used
    kWaits,    // the images that follow will decide
    kBegins,   // the images that wait and this one begin a session
    kGoesOn,   // the images that wait and this one go on after a pause
    kDoubled,  // has the time of the last image
  };
  enum class Doubt { kNone, kNoTime, kOlder, kAhead };

  // A session begins with the first image whose time is near the clock, or with two whose times rise as a camera's do.
  // Other images wait. Ten in a row with such times that are older than the last image begin another session; five in a
  // row that are far ahead of it go on after a pause. Times that stand still or have another unit never make such a
  // row. `is_checked`: camera_driver has checked the times of the whole recording.
  Verdict judge(int64_t utime_us, int64_t now_us, bool is_checked = false);
  // Notes the time of an image that is used. Later images must be newer.
  void take(int64_t utime_us, int64_t now_us);
  // Forgets the times of the session before.
  void begin_session();
  // Gives up the images that wait.
  void forget_row() { row_ = 0; }

  int row() const { return row_; }        // number of images that wait, with the last one
  Doubt doubt() const { return doubt_; }  // doubt about the time of the last image
  bool are_none() const;                  // true: the latest times did not rise as a camera's do
  std::string what_is_wrong() const;      // text about the times if are_none()
  // Returns the time that the next image must exceed: the one given to the last take() of this session (1 us before the
  // first of the waiting images, if judge() has just let them in), or kNever.
  int64_t last_us() const { return last_us_; }
  static constexpr int64_t kNever = INT64_MIN;

 private:
  struct Moment {
    int64_t utime_us = kNever, clock_us = 0;
  };
  Doubt doubt_about(const Moment& image, bool is_checked) const;
  Verdict end_row();

  int64_t last_us_ = kNever, last_clock_us_ = 0, last_step_us_ = 0;  // times and step given to take()
  Moment before_, first_of_row_;                                     // before_: the last image, used or not
  int64_t step_us_ = 0, clock_step_us_ = 0;                          // steps from the image before to the last one
  int row_ = 0, wrong_steps_ = 0;                                    // numbers of images in a row
  Doubt doubt_ = Doubt::kNone;
};

}  // namespace rumi::front_tracker
