// SPDX-License-Identifier: BSD-3-Clause
// Queue of requests for a snapshot. A snapshot shows everything received before the request, merged into one map, so a
// request passes three states, first come first served:
//
//   waiting    until everything received is merged     note_all_is_merged()
//   merged     until the copies before it are made     tick()
//   copying    until its copy is made                  tick(), which then answers it
#pragma once

#include <functional>
#include <future>
#include <optional>
#include <vector>

#include "lcmtypes/rumi/map_request_t.hpp"
#include "map_server/store/map_store.h"

namespace rumi::map_server {

class SnapshotQueue {
 public:
  struct Calls {
    std::function<Result<>()> save;  // stores everything received so far; called before each copy
    std::function<bool()> has_room;  // whether another copy may be made and sent
    std::function<void(const map_request_t&, Result<DatabaseBytes>)> answer;
  };
  SnapshotQueue(MapStore& store, bool in_thread, Calls calls);

  void add(const map_request_t& request) { waiting_.push_back(request); }
  void note_all_is_merged();
  // Answers the request whose copy is finished, and begins copies as long as there is room. Makes only one at a time,
  // because copies may be large.
  void tick();

  bool contains(const map_request_t& request) const;
  size_t size() const { return waiting_.size() + merged_.size(); }  // without the request whose copy is being made
  bool has_merged() const { return !merged_.empty(); }
  bool is_copying() const { return copying_for_.has_value(); }

 private:
  void end_copy();

  MapStore& store_;
  bool in_thread_;
  Calls calls_;
  std::vector<map_request_t> waiting_, merged_;
  std::optional<map_request_t> copying_for_;
  std::future<Result<DatabaseBytes>> copy_;  // valid while copying_for_ is set
};

}  // namespace rumi::map_server
