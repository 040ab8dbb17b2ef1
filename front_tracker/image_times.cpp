// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/image_times.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

namespace rumi::front_tracker {
namespace {

constexpr int64_t kNearClockUs = 10'000'000;  // largest distance of an image's time from the clock; clocks of two
                                              // computers may differ
constexpr int64_t kShortestStepUs = 500;      // shortest step of a high-speed camera
// Times count as nanoseconds if they rise by more than kLongStepUs per image, and more than kFastestPace times as fast
// as the clock: no recording is played so fast.
constexpr int64_t kLongStepUs = 10'000'000, kFastestPace = 300;
// A time is far ahead if its step exceeds kAheadUs, many times the clock's step and many times the step before.
constexpr int64_t kAheadUs = 1'000'000, kTimesTheClock = 20, kTimesTheStep = 10;
constexpr int kRowOfFirst = 2, kRowOfOlder = 10, kRowOfAhead = 5;
constexpr int kWrongStepsToTell = 3;

bool is_step_of_camera(int64_t step_us, int64_t clock_step_us) {
  const bool is_too_long = step_us > kLongStepUs && step_us / kFastestPace > clock_step_us;
  return step_us >= kShortestStepUs && !is_too_long;
}

int enough(ImageTimes::Doubt doubt) {
  if (doubt == ImageTimes::Doubt::kOlder) return kRowOfOlder;
  return doubt == ImageTimes::Doubt::kAhead ? kRowOfAhead : kRowOfFirst;
}

// Returns a hint at the unit in which the time would agree with the clock; empty if it is neither seconds nor
// milliseconds.
std::string question_about_unit(int64_t utime_us, int64_t clock_us) {
  constexpr double kSame = 0.01;
  const auto is_near = [&](double factor) {
    return std::abs(factor * static_cast<double>(utime_us) / static_cast<double>(clock_us) - 1) < kSame;
  };
  if (clock_us <= 0) return {};
  if (is_near(1e6)) return ", as seconds do";
  if (is_near(1e3)) return ", as milliseconds do";
  return {};
}

}  // namespace

ImageTimes::Doubt ImageTimes::doubt_about(const Moment& image, bool is_checked) const {
  if (last_us_ == kNever)
    return is_checked || std::abs(image.utime_us - image.clock_us) <= kNearClockUs ? Doubt::kNone : Doubt::kNoTime;
  if (image.utime_us <= last_us_) return Doubt::kOlder;
  if (is_checked) return Doubt::kNone;
  const int64_t ahead_us = image.utime_us - last_us_;
  const bool is_ahead = ahead_us > kAheadUs && ahead_us / kTimesTheClock > image.clock_us - last_clock_us_ &&
                        ahead_us / kTimesTheStep > last_step_us_;
  return is_ahead ? Doubt::kAhead : Doubt::kNone;
}

ImageTimes::Verdict ImageTimes::judge(int64_t utime_us, int64_t now_us, bool is_checked) {
  const Moment image{utime_us, now_us};
  const bool is_first = before_.utime_us == kNever;
  step_us_ = is_first ? -1 : utime_us - before_.utime_us;
  clock_step_us_ = is_first ? 0 : now_us - before_.clock_us;
  const bool is_step = !is_first && (is_checked ? step_us_ > 0 : is_step_of_camera(step_us_, clock_step_us_));
  // A large step back does not mean that the unit is wrong.
  const bool is_wrong = !is_first && !is_step && step_us_ > -kShortestStepUs;
  wrong_steps_ = is_wrong ? wrong_steps_ + 1 : 0;
  before_ = image;

  const Doubt doubt = doubt_about(image, is_checked);
  const Doubt of_row = row_ > 0 ? doubt_ : Doubt::kNone;
  // True if the clock has reached the times that were far ahead.
  const bool caught_up = doubt == Doubt::kNone && of_row == Doubt::kAhead && is_step;
  if (doubt == Doubt::kNone && !caught_up) {
    doubt_ = Doubt::kNone;
    return Verdict::kNext;
  }
  if (!caught_up) doubt_ = doubt;
  if (doubt != Doubt::kNone && utime_us == last_us_ && !are_none()) return Verdict::kDoubled;
  row_ = of_row == doubt_ && is_step ? row_ + 1 : 1;
  if (row_ == 1) first_of_row_ = image;
  if (row_ < enough(doubt_) && !caught_up) return Verdict::kWaits;
  return end_row();
}

// Ends the row of waiting images. They will be judged again, and then be taken.
ImageTimes::Verdict ImageTimes::end_row() {
  last_us_ = first_of_row_.utime_us - 1;
  last_clock_us_ = first_of_row_.clock_us;
  last_step_us_ = step_us_;
  before_ = {};
  row_ = 0;
  return doubt_ == Doubt::kAhead ? Verdict::kGoesOn : Verdict::kBegins;
}

void ImageTimes::take(int64_t utime_us, int64_t now_us) {
  if (last_us_ != kNever && utime_us - last_us_ > 1) last_step_us_ = utime_us - last_us_;
  last_us_ = utime_us;
  last_clock_us_ = now_us;
  row_ = 0;
}

void ImageTimes::begin_session() {
  last_us_ = kNever;
  last_step_us_ = 0;
  row_ = 0;
}

bool ImageTimes::are_none() const { return wrong_steps_ >= kWrongStepsToTell; }

std::string ImageTimes::what_is_wrong() const {
  const std::string unit = question_about_unit(before_.utime_us, before_.clock_us);
  if (step_us_ < 0) return fmt::format("the time of an image ({}) is far from the clock's", before_.utime_us);
  if (step_us_ == 0) return fmt::format("the times of the images stand ({}){}", before_.utime_us, unit);
  if (step_us_ > kLongStepUs)
    return fmt::format("the times of the images rise by {:.3g} s in {:.3g} s, as nanoseconds do",
                       1e-6 * static_cast<double>(step_us_), 1e-6 * static_cast<double>(clock_step_us_));
  return fmt::format("the times of the images rise by {} us in {:.3g} ms{}", step_us_,
                     1e-3 * static_cast<double>(clock_step_us_), unit);
}

}  // namespace rumi::front_tracker
