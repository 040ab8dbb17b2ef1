// SPDX-License-Identifier: BSD-3-Clause
// Images that front_tracker does not use, by reason.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace rumi::front_tracker {

class RefusedImages {
 public:
  enum class Kind {
    kNoImage,      // a message of another type, or broken
    kNoTime,       // its time is no microsecond of a clock
    kOlder,        // than the image before
    kDoubled,      // of the time of the image before
    kAhead,        // far ahead of those around it
    kOtherCamera,  // by its stream or calibration
    kCalibration,  // missing, or cannot be read
    kSize,         // not of its calibration's size
    kDamaged,      // cannot be decoded
  };

  // One more. The first of a kind is said in the log.
  void add(Kind kind, const std::string& problem);
  // Those of whom the next images tell: counted, and not said yet ...
  void count(Kind kind) { ++counts_[kind]; }
  void tell(Kind kind, const std::string& problem);                     // ... they are refused
  void take_back(Kind kind, int64_t count) { counts_[kind] -= count; }  // ... they are not

  int64_t of(Kind kind) const;
  int64_t total() const;
  // ", 75 images refused: size, 2 images refused: damaged"; empty if there are none.
  std::string text() const;
  // Some were refused since the last call.
  bool take_news() { return std::exchange(news_, false); }
  // Of all images that came: a sentence for each reason for which more than 1 % were refused, with what to do.
  std::vector<std::string> complaints(int64_t all) const;

 private:
  std::map<Kind, int64_t> counts_;
  std::map<Kind, std::string> told_;  // the first problem of a kind
  bool news_ = false;
};

}  // namespace rumi::front_tracker
