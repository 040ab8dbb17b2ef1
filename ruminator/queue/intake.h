// SPDX-License-Identifier: BSD-3-Clause
// Adds windows to the queue: those of the node, and those that an earlier process left in the spool. If there are too
// many, drops the oldest.
#pragma once

#include <cstdint>
#include <string>
#include <variant>

#include "base/result.h"
#include "bus/transport/bus.h"
#include "ruminator/queue/queue_options.h"
#include "ruminator/queue/queued_windows.h"

namespace rumi::ruminator {

class Intake {
 public:
  // Adopts the windows in the spool. All arguments must outlive this object.
  Intake(Bus& bus, QueuedWindows& windows, const RebuildQueueOptions& options);

  // Returns false if the spool has the window already, because another process shares the spool.
  bool add(WindowJob job);
  // Announces that a window failed, because it cannot become a job.
  void refuse(const RuminationWindow& window, const std::string& reason);
  // Looks in the spool now and then for windows whose ruminator has died.
  void tick(int64_t now_us);

 private:
  using Place = std::variant<InSpool, InMemory>;

  void adopt();
  void adopt_window(JobName name);
  void adopt_submap(JobName name);
  std::optional<Place> place(WindowJob job);
  void make_room();
  void drop(QueuedWindows::Entries::iterator entry, const std::string& reason);

  Bus& bus_;
  QueuedWindows& windows_;
  const RebuildQueueOptions& options_;
  int64_t last_adopted_us_ = 0;
};

}  // namespace rumi::ruminator
