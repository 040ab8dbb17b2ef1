// SPDX-License-Identifier: BSD-3-Clause
// Listens to the newer one of two senders of the same messages on one bus. The other one is mostly a log that is played
// with all its channels beside a running system.
#pragma once

#include <cstdint>
#include <string>

namespace rumi {

inline constexpr int64_t kLateUs = 2'000'000;  // slack for the time at which a message was sent

class NewestSender {
 public:
  // what: the name of the messages for the log, "RUMI_TRACK"; empty: nothing is logged. slack: by this much a number
  // may be lower.
  explicit NewestSender(std::string what, int64_t slack = 0) : what_(std::move(what)), slack_(slack) {}

  // number: rises from message to message of a sender, and from sender to sender: the time at which the message was
  // sent, or at which its session began. False for a lower number as long as the other sender was heard in the last
  // five seconds.
  bool take(int64_t number, int64_t now_us);
  // As above, without telling or counting.
  bool is_older(int64_t number, int64_t now_us) const;
  int64_t refused() const { return refused_; }

 private:
  bool is_lower(int64_t number) const { return newest_ >= INT64_MIN + slack_ && number < newest_ - slack_; }

  std::string what_;
  int64_t slack_;
  int64_t newest_ = INT64_MIN;
  int64_t heard_us_ = INT64_MIN;
  int64_t refused_ = 0;
  bool told_ = false;
};

}  // namespace rumi
