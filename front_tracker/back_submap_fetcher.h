// SPDX-License-Identifier: BSD-3-Clause
// Gets back submaps from map_server as soon as they are part of the map: what the map does not hang together with is
// not asked for.
#pragma once

#include <functional>
#include <map>
#include <string>

#include "bus/transfer/chunked_transfer.h"
#include "bus/wire/map_overview.h"
#include "slam/map/submap.h"

namespace rumi::front_tracker {

class BackSubmapFetcher {
 public:
  struct Handlers {
    // Returns why the submap cannot be used, or an empty string.
    std::function<std::string(Submap submap)> take;
    // The map does not hold this submap any longer.
    std::function<void(int id)> forget;
  };
  // Larger submaps than of max_keyframes are not asked for.
  BackSubmapFetcher(Bus& bus, const std::string& process_name, int max_keyframes, Handlers handlers);

  // Those of this session from now on, and nothing of them is known.
  void begin_session(int64_t session);
  void on_map(const MapOverview& map);
  void tick(int64_t now_us);

  int64_t refused() const { return refused_; }
  // Why the last one was refused, or empty.
  const std::string& problem() const { return problem_; }

 private:
  ChunkReceiver::Verdict on_payload(const ChunkReceiver::Payload& payload);
  void ask(int64_t now_us);
  void refuse(const std::string& why);

  Bus& bus_;
  std::string name_;
  int max_keyframes_;
  Handlers handlers_;
  ChunkReceiver receiver_;
  int64_t session_ = 0;
  std::map<int, int64_t> listed_;   // back submaps in the map: id, revision
  std::map<int, int64_t> settled_;  // of these, the revision that was taken or refused
  int32_t last_request_ = 0;
  int asked_for_ = kNoSubmap;  // by the last request, until it is answered
  int64_t next_try_us_ = 0;
  int64_t refused_ = 0;
  std::string problem_;
};

}  // namespace rumi::front_tracker
