// SPDX-License-Identifier: BSD-3-Clause
// Holds the answers to RUMI_MAP_REQUEST that are being sent, and answers requests that need only the atlas: for
// submaps, the trajectory and regions. The node answers requests for snapshots and for RUMI_MAP_STATUS.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "bus/transfer/chunked_transfer.h"
#include "bus/transport/bus.h"
#include "lcmtypes/rumi/map_request_t.hpp"
#include "map_server/atlas/atlas.h"

namespace rumi::map_server {

class Answers {
 public:
  static constexpr int kMost = 4;  // most answers being sent at a time, refusals apart; a further request is refused

  Answers(Bus& bus, const Atlas& atlas);
  void tick(int64_t now_us) { sender_.tick(now_us); }

  // Answers a request for a submap, the trajectory or a region, or refuses it with a reason.
  void answer(const map_request_t& request);
  void send(const map_request_t& request, int8_t kind, std::vector<uint8_t> payload,
            std::optional<int64_t> checksum = {});
  // Answers with the reason `why`. If too many answers are being sent, sends nothing: the requester asks again.
  void refuse(const map_request_t& request, const std::string& why);

  bool is_under_way(const map_request_t& request) const;
  int large() const { return large_; }  // answers being sent, refusals apart
  int64_t refused() const { return refused_; }
  bool is_idle() const { return sender_.pending() == 0; }

 private:
  void answer_submap(const map_request_t& request);
  void answer_placed_submap(const map_request_t& request);
  void answer_region(const map_request_t& request);
  const AtlasSubmap* find_or_refuse(const map_request_t& request);

  Bus& bus_;
  const Atlas& atlas_;
  ChunkSender sender_;
  std::set<std::pair<std::string, int32_t>> under_way_;  // (requester, request_id) of the answers being sent
  int large_ = 0;
  int64_t refused_ = 0;
};

}  // namespace rumi::map_server
