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
    kNoImage,      // the message has another type, or is broken
    kNoTime,       // its time is not in microseconds since 1970
    kOlder,        // it is older than the image before
    kDoubled,      // it has the time of the image before
    kAhead,        // its time is far ahead of the times around it
    kOtherCamera,  // it has another stream or calibration
    kCalibration,  // its calibration is missing or cannot be read
    kSize,         // its size is not that of its calibration
    kDamaged,      // it cannot be decoded
  };

  // Counts one more image. The first of each kind is logged.
  void add(Kind kind, const std::string& problem);
  // Counts an image as refused, without logging it. The next images decide: then tell() or take_back() is called.
  void count(Kind kind) { ++counts_[kind]; }
  void tell(Kind kind, const std::string& problem);  // logs counted images that are refused now
  // Subtracts images that are used after all.
  void take_back(Kind kind, int64_t count) { counts_[kind] -= count; }

  int64_t of(Kind kind) const;
  int64_t total() const;
  // Returns ", 75 images refused: size, 2 images refused: damaged"; empty if there are none.
  std::string text() const;
  // True if an image was refused since the last call.
  bool take_news() { return std::exchange(news_, false); }
  // Returns a sentence, with what to do, for each reason for which more than 1 % of all images were refused.
  std::vector<std::string> complaints(int64_t all) const;

 private:
  std::map<Kind, int64_t> counts_;
  std::map<Kind, std::string> told_;  // first problem of each kind
  bool news_ = false;
};

}  // namespace rumi::front_tracker
