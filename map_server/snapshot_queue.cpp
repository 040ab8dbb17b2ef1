// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/snapshot_queue.h"

#include <algorithm>
#include <utility>

#include "base/running/is_ready.h"
#include "base/running/stage_clock.h"

namespace rumi::map_server {

SnapshotQueue::SnapshotQueue(MapStore& store, bool in_thread, Calls calls)
    : store_(store), in_thread_(in_thread), calls_(std::move(calls)) {}

void SnapshotQueue::note_all_is_merged() {
  merged_.insert(merged_.end(), waiting_.begin(), waiting_.end());
  waiting_.clear();
}

void SnapshotQueue::tick() {
  end_copy();
  while (!copying_for_ && !merged_.empty() && calls_.has_room()) {
    const Result<> saved = calls_.save();
    if (saved && store_.is_behind()) return;  // the copy would lack what the next save() writes
    const map_request_t request = merged_.front();
    merged_.erase(merged_.begin());
    if (!saved) {
      calls_.answer(request, saved.error());
      continue;
    }
    copying_for_ = request;
    copy_ = store_.begin_copy_bytes(in_thread_);
    end_copy();
  }
}

void SnapshotQueue::end_copy() {
  if (!is_ready(copy_)) return;
  const StageClock clock("map_server.answer");
  Result<DatabaseBytes> copy = copy_.get();
  const map_request_t request = *std::exchange(copying_for_, std::nullopt);
  calls_.answer(request, std::move(copy));
}

bool SnapshotQueue::contains(const map_request_t& request) const {
  const auto same = [&](const map_request_t& other) {
    return other.requester == request.requester && other.request_id == request.request_id;
  };
  return (copying_for_ && same(*copying_for_)) || std::any_of(waiting_.begin(), waiting_.end(), same) ||
         std::any_of(merged_.begin(), merged_.end(), same);
}

}  // namespace rumi::map_server
