// SPDX-License-Identifier: BSD-3-Clause
// Whether the time of an image goes on from that of the one before, by what the clock says when they come. A recording
// has been looked at as a whole before; live nobody knows what comes next.
#pragma once

#include <cstdint>
#include <string>

namespace rumi::front_tracker {

class ImageTimes {
 public:
  enum class Verdict {
    kNext,     // goes on from the last one that was taken
    kWaits,    // the next ones tell
    kBegins,   // the row that waits, this one included, begins a session
    kGoesOn,   // the row goes on after a pause
    kDoubled,  // of the time of the last one
  };
  enum class Doubt { kNone, kNoTime, kOlder, kAhead };

  // Near the clock a session begins with the first image, else with two whose times rise as those of a camera do; ten
  // such older than the last one begin another session; five such far ahead of it go on after a pause. Times that stand
  // or have another unit never get so far. camera_driver has looked at all times of what it plays (`is_checked`).
  Verdict judge(int64_t utime_us, int64_t now_us, bool is_checked = false);
  // It was used: later ones are to be newer.
  void take(int64_t utime_us, int64_t now_us);
  // The times of two sessions have nothing to do with each other.
  void begin_session();
  // What waits is given up.
  void forget_row() { row_ = 0; }

  int row() const { return row_; }              // images in a row, with the last one
  Doubt doubt() const { return doubt_; }        // of the last image
  bool are_none() const;                        // for some images the times were not those of a camera
  std::string what_is_wrong() const;            // with the times, then
  int64_t last_us() const { return last_us_; }  // that was taken; kNever: none
  static constexpr int64_t kNever = INT64_MIN;

 private:
  struct Moment {
    int64_t utime_us = kNever, clock_us = 0;
  };
  Doubt doubt_about(const Moment& image, bool is_checked) const;
  Verdict end_row();

  int64_t last_us_ = kNever, last_clock_us_ = 0, last_step_us_ = 0;  // of those that were taken
  Moment before_, first_of_row_;                                     // the last image, taken or not
  int64_t step_us_ = 0, clock_step_us_ = 0;                          // to the last image
  int row_ = 0, wrong_steps_ = 0;                                    // in a row
  Doubt doubt_ = Doubt::kNone;
};

}  // namespace rumi::front_tracker
