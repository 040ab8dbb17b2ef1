// SPDX-License-Identifier: BSD-3-Clause
// Small valid messages, for seeds.
#pragma once

#include "bus/wire/submap_update.h"
#include "fuzz/script.h"
#include "lcmtypes/rumi/chunk_ack_t.hpp"
#include "lcmtypes/rumi/image_t.hpp"
#include "lcmtypes/rumi/map_request_t.hpp"
#include "lcmtypes/rumi/map_status_t.hpp"
#include "lcmtypes/rumi/mask_t.hpp"
#include "lcmtypes/rumi/track_t.hpp"

namespace rumi::fuzz {

inline constexpr int64_t kSession = 1'000'000;
inline constexpr int kWidth = 64, kHeight = 48;

Camera good_camera();
// An image whose texture depends on the time.
image_t good_image(int64_t utime_us);
image_t good_jpeg(int64_t utime_us);
// A submap of `keyframes` keyframes, which move sideways and see some of its few landmarks.
Submap good_submap(SubmapKey key, int keyframes);
track_t good_track(int64_t utime_us, int8_t state, int32_t submap_id);
// A mask that leaves out the lowest 8 rows.
mask_t good_mask(int64_t utime_us);
map_status_t good_status(const std::vector<SubmapKey>& submaps);
map_request_t good_request(int8_t what, SubmapKey key);
chunk_ack_t good_ack(int64_t transfer_id, int8_t status);

template <class Message>
Event message(uint8_t channel, const Message& message) {
  return {channel, encode_message(message)};
}
inline Event pause(uint8_t exponent) { return {Event::kTime, {exponent}}; }
// Returns an event that sends `message` as the answer to the latest request of the node.
template <class Message>
Event payload(int8_t kind, const Message& message) {
  Event event{Event::kPayload, {static_cast<uint8_t>(kind), 0}};
  const Bytes bytes = encode_message(message);
  event.bytes.insert(event.bytes.end(), bytes.begin(), bytes.end());
  return event;
}

}  // namespace rumi::fuzz
