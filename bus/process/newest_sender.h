// SPDX-License-Identifier: BSD-3-Clause
// Listens to the newer one of two senders of the same messages on one bus. The other one is usually a log that is
// played with all its channels beside a running system.
#pragma once

#include <cstdint>
#include <string>

namespace rumi {

inline constexpr int64_t kLateUs = 2'000'000;  // slack for numbers that are the times at which messages were sent

class NewestSender {
 public:
  // `what`: name of the messages in the log's warning, such as "RUMI_TRACK"; empty: nothing is logged. `slack`: a
  // number that is lower than the newest one by no more than this does not count as older.
  explicit NewestSender(std::string what, int64_t slack = 0) : what_(std::move(what)), slack_(slack) {}

  // Returns false if the message is not to be used: its number is lower than that of another sender who was heard in
  // the last five seconds. `number` rises from message to message of a sender, and from sender to sender: it is the
  // time at which the message was sent, or at which the sender's session began.
  bool take(int64_t number, int64_t now_us);
  // True if the number is older in the sense of take(). Logs and counts nothing.
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
