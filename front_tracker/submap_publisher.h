// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>

#include "base/running/due.h"
#include "bus/transfer/chunked_transfer.h"
#include "front_tracker/tracking/tracker.h"

namespace rumi::front_tracker {

// Keeps map_server's copies of the submaps up to date: sends what changed since the revision that the server has
// stored, one update per submap at a time.
class SubmapPublisher {
 public:
  SubmapPublisher(Bus& bus, const std::string& sender_name, double interval_s);

  // Sends what is due by frame time; `all` sends whatever the server does not have yet, closed submaps marked so.
  void publish(Tracker& tracker, int64_t now_us, bool all);
  void tick(int64_t now_us) { sender_.tick(now_us); }
  // The server has stored everything of these submaps, and knows that they are closed.
  bool complete(Tracker& tracker) const;
  // Rises while map_server takes what is sent, see Node::handed_on().
  int64_t handed_on() const { return failure_.empty() ? sender_.acknowledged() : 0; }
  // Why the last transfer failed, or empty.
  const std::string& failure() const { return failure_; }

 private:
  struct Progress {
    int64_t stored_revision = 0;  // by the server, as it says
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
