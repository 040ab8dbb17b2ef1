// SPDX-License-Identifier: BSD-3-Clause
// Counts the images that front_tracker does not use, by reason.
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
    kNoTime,       // its time is not in microseconds of a clock
    kOlder,        // it is older than the image before
    kDoubled,      // it has the time of the image before
    kAhead,        // its time is far ahead of those around it
    kOtherCamera,  // it has another stream or calibration
    kCalibration,  // its calibration is missing or cannot be read
    kSize,         // it does not have its calibration's size
    kDamaged,      // it cannot be decoded
  };

  // Counts one more image. The first of a kind is logged.
  void add(Kind kind, const std::string& problem);
  // For images about which the next ones decide: counts one without logging it ...
  void count(Kind kind) { ++counts_[kind]; }
  void tell(Kind kind, const std::string& problem);                     // ... logs it when they are refused
  void take_back(Kind kind, int64_t count) { counts_[kind] -= count; }  // ... or takes them back

  int64_t of(Kind kind) const;
  int64_t total() const;
  // ", 75 images refused: size, 2 images refused: damaged"; empty if there are none.
  std::string text() const;
  // True if an image was refused since the last call.
  bool take_news() { return std::exchange(news_, false); }
  // Returns a sentence, with what to do, for each reason for which more than 1 % of all images were refused.
  std::vector<std::string> complaints(int64_t all) const;

 private:
  std::map<Kind, int64_t> counts_;
  std::map<Kind, std::string> told_;  // the first problem of a kind
  bool news_ = false;
};

}  // namespace rumi::front_tracker
