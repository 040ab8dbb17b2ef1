// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>

#include "base/running/due.h"
#include "bus/transfer/chunked_transfer.h"
#include "front_tracker/tracking/tracker.h"

namespace rumi::front_tracker {

// Keeps map_server's copies of the submaps up to date. It sends the changes since the revision that the server has
// stored, one update of a submap at a time.
class SubmapPublisher {
 public:
  SubmapPublisher(Bus& bus, const std::string& sender_name, double interval_s);

  // Sends the submaps whose next update is due. If `all`, closes all submaps and sends all that the server lacks.
  void publish(Tracker& tracker, int64_t now_us, bool all);
  void tick(int64_t now_us) { sender_.tick(now_us); }
  // True if the server has stored all of the tracker's submaps completely, and they are closed.
  bool complete(Tracker& tracker) const;
  // Returns a number that rises as long as map_server accepts updates; see Node::handed_on().
  int64_t handed_on() const { return failure_.empty() ? sender_.acknowledged() : 0; }
  // Returns why the last transfer failed; empty if it succeeded.
  const std::string& failure() const { return failure_; }

 private:
  struct Progress {
    int64_t stored_revision = 0;  // the revision that the server says it has stored
    int64_t last_sent_us = kNever_us;
    bool in_flight = false;
  };
  void send(FrontSubmap& submap, Progress* progress);
  ChunkSender sender_;
  double interval_s_;
  std::map<SubmapKey, Progress> progress_;
  std::string failure_;
};

}  // namespace rumi::front_tracker
