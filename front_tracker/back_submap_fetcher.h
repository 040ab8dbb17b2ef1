// SPDX-License-Identifier: BSD-3-Clause
// Fetches back submaps from map_server as soon as they are part of the map. Submaps that are not connected to the map
// are not requested.
#pragma once

#include <functional>
#include <map>
#include <span>
#include <string>

#include "base/result.h"
#include "base/running/due.h"
#include "bus/transfer/chunked_transfer.h"
#include "bus/wire/map_overview.h"
#include "slam/map/submap.h"

namespace rumi::front_tracker {

class BackSubmapFetcher {
 public:
  struct Handlers {
    // Takes a fetched submap. Returns an Error if it cannot be used.
    std::function<Result<>(Submap submap)> take;
    // Called when the map no longer has this submap.
    std::function<void(int id)> forget;
  };
  // Submaps with more than `max_keyframes` keyframes are refused without a request.
  BackSubmapFetcher(Bus& bus, const std::string& process_name, int max_keyframes, Handlers handlers);

  // From now on fetches the back submaps of this session, none of which is known yet.
  void begin_session(int64_t session);
  void on_map(const MapOverview& map);
  void tick(int64_t now_us);

  int64_t refused() const { return refused_; }
  // Returns the reason for the last refusal; empty if there was none.
  const std::string& problem() const { return problem_; }

 private:
  ChunkReceiver::Verdict on_payload(const ChunkReceiver::Payload& payload);
  Result<> take(int id, std::span<const uint8_t> bytes);
  void ask(int64_t now_us);
  void refuse(const std::string& why);

  Bus& bus_;
  std::string name_;
  int max_keyframes_;
  Handlers handlers_;
  ChunkReceiver receiver_;
  int64_t session_ = 0;
  std::map<int, int64_t> listed_;   // by id: revision of the back submaps in the map
  std::map<int, int64_t> settled_;  // by id: revision that was taken or refused
  int32_t last_request_ = 0;
  int asked_for_ = kNoSubmap;  // submap of the request that is not answered yet
  int64_t asked_us_ = kNever_us;
  int64_t refused_ = 0;
  std::string problem_;
};

}  // namespace rumi::front_tracker
