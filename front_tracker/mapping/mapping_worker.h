// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>

#include "front_tracker/mapping/mapper.h"

namespace rumi::front_tracker {

// Gives keyframes to the mapper: in a thread of its own (live) or at once (replay).
class MappingWorker {
 public:
  MappingWorker(const Mapper& mapper, std::mutex& map_mutex, bool threaded);
  ~MappingWorker();  // finishes the keyframe at hand, forgets the others

  // Call without holding the map's mutex.
  void post(FrontSubmap* submap, int keyframe_id);
  // Keyframes waiting or at work.
  int pending() const;
  void wait_until_idle();

 private:
  void run();
  const Mapper& mapper_;
  std::mutex& map_mutex_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<std::pair<FrontSubmap*, int>> queue_;
  bool working_ = false, stop_ = false;
  std::thread thread_;
};

}  // namespace rumi::front_tracker
