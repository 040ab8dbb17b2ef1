// SPDX-License-Identifier: BSD-3-Clause
#include "bus/process/newest_sender.h"

#include <algorithm>
#include <utility>

#include "base/running/log.h"

namespace rumi {
namespace {

constexpr int64_t kSilentUs = 5'000'000;
constexpr int64_t kFutureUs = 60'000'000;  // largest expected difference between the clocks of two computers

}  // namespace

// If the clock goes back (a log begins again), the result is false: else everything would be refused until the clock
// has caught up.
bool NewestSender::is_older(int64_t number, int64_t now_us) const {
  return is_lower(number) && now_us >= heard_us_ && now_us - heard_us_ <= kSilentUs;
}

bool NewestSender::take(int64_t number, int64_t now_us) {
  // A number far in the future comes from a broken message, or is the session of a replay that is numbered above those
  // of its map. The message is used, but says nothing about other senders.
  if (number > now_us && now_us >= 0 && number - now_us > kFutureUs) return true;
  if (!is_older(number, now_us)) {
    newest_ = is_lower(number) ? number : std::max(newest_, number);
    heard_us_ = now_us;
    return true;
  }
  ++refused_;
  if (!std::exchange(told_, true) && !what_.empty())
    log_warning(
        "{} of another, older run comes in beside the present one: it is not used. Is a log played with all its "
        "channels? Then play CAMERA alone, or on a bus of its own",
        what_);
  return false;
}

}  // namespace rumi
