// SPDX-License-Identifier: BSD-3-Clause
// How windows enter the queue: from the node, or from the spool, where an earlier process left them. If there are too
// many, the oldest are dropped.
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
  // Adopts what the spool holds. All arguments must outlive this.
  Intake(Bus& bus, QueuedWindows& windows, const RebuildQueueOptions& options);

  // False if the spool has the window already: another process shares the spool.
  bool add(WindowJob job);
  // Announces a window that cannot become a job as failed.
  void refuse(const RuminationWindow& window, const std::string& reason);
  // Looks into the spool now and then for windows whose ruminator has died.
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
