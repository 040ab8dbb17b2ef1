// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/mask_intake.h"

#include "base/running/log.h"

namespace rumi::map_server {

bool MaskIntake::take(const mask_t& message, Atlas* atlas) {
  StillMask mask{.session = message.session,
                 .utime_us = message.utime,
                 .width = message.width,
                 .height = message.height,
                 .left_out = message.left_out,
                 .png = {message.png.begin(), message.png.end()}};
  const auto known = atlas->masks().find(message.stream);
  if (known != atlas->masks().end() && known->second.is_same(mask)) return false;
  if (const Result<> checked = check(message.stream, mask); !checked) {
    if (++rejected_ == 1) log_warning("a mask is rejected: {} (further ones are only counted)", checked.error().text());
    return false;
  }
  return atlas->record_mask(message.stream, std::move(mask));
}

}  // namespace rumi::map_server
