// SPDX-License-Identifier: BSD-3-Clause
// Judges whether an image's time goes on from that of the image before, compared with the clock when the images arrive.
// camera_driver checks a recording as a whole before; live, nobody knows what comes next.
#pragma once

#include <cstdint>
#include <string>

namespace rumi::front_tracker {

class ImageTimes {
 public:
  enum class Verdict {
    kNext,     // it goes on from the last image that was taken
    kWaits,    // the next images decide
    kBegins,   // the waiting row, with this image, begins a session
    kGoesOn,   // the waiting row goes on after a pause
    kDoubled,  // it has the time of the last image
  };
  enum class Doubt { kNone, kNoTime, kOlder, kAhead };

  // A session begins with the first image whose time is near the clock, or with two whose times rise as a camera's do.
  // Ten such images that are older than the last one begin another session; five that are far ahead of it go on after a
  // pause. Times that stand still or have another unit never get so far. `is_checked`: camera_driver has checked the
  // times of the whole recording.
  Verdict judge(int64_t utime_us, int64_t now_us, bool is_checked = false);
  // The image was used. Later ones must be newer.
  void take(int64_t utime_us, int64_t now_us);
  // Forgets the times of the session before.
  void begin_session();
  // The waiting row is given up.
  void forget_row() { row_ = 0; }

  int row() const { return row_; }              // length of the row, with the last image
  Doubt doubt() const { return doubt_; }        // about the last image
  bool are_none() const;                        // the last few times were not those of a camera
  std::string what_is_wrong() const;            // what is wrong with the times then
  int64_t last_us() const { return last_us_; }  // of the last image that was taken; kNever if there is none
  static constexpr int64_t kNever = INT64_MIN;

 private:
  struct Moment {
    int64_t utime_us = kNever, clock_us = 0;
  };
  Doubt doubt_about(const Moment& image, bool is_checked) const;
  Verdict end_row();

  int64_t last_us_ = kNever, last_clock_us_ = 0, last_step_us_ = 0;  // the images that were taken
  Moment before_, first_of_row_;                                     // the last image, taken or not
  int64_t step_us_ = 0, clock_step_us_ = 0;                          // from the image before to the last one
  int row_ = 0, wrong_steps_ = 0;                                    // lengths of rows
  Doubt doubt_ = Doubt::kNone;
};

}  // namespace rumi::front_tracker
