// SPDX-License-Identifier: BSD-3-Clause
// Delivers finished back submaps to map_server, one at a time. The states of a back submap, and why they exist:
//
//   made, tested    BuildWorker applies its message to a copy of the submap. map_server makes the same check and would
//                   refuse an inconsistent submap again and again.
//   stored          store() puts the message into the spool, so that no window is rebuilt twice if this process dies,
//                   and no memory is held while map_server is away. Without a spool it stays in memory.
//   read, decoded   send_next() decodes what it reads from the spool: the file may be damaged, or written by another
//                   version, and map_server would not acknowledge it. A message in memory is sent as it is.
//   sent            in chunks (ChunkSender); again after a while if map_server refuses it or does not answer.
//   acknowledged    map_server has stored it. Only now is it removed from the spool.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/result.h"
#include "bus/transfer/chunked_transfer.h"
#include "bus/transport/bus.h"
#include "ruminator/queue/queued_windows.h"

namespace rumi::ruminator {

class Delivery {
 public:
  Delivery(Bus& bus, QueuedWindows& windows, double retry_s);

  // Stores a back submap (an encoded message) that has just been built. The entry's state becomes Built.
  void store(QueueEntry& entry, std::vector<uint8_t> submap);
  // To be called as often as possible while a submap is being sent.
  void tick(int64_t now_us) { sender_.tick(now_us); }
  // Sends the next submap that is due, unless one is being sent already.
  void send_next(int64_t now_us);
  // From now on sends each submap at once, and only once. If the last attempt failed, sends no more: submaps in the
  // spool wait for the next start, and those in memory are lost.
  void finish();

  int published() const { return published_; }             // back submaps that map_server has acknowledged
  const std::string& problem() const { return problem_; }  // why the last submap was not accepted; empty if it was

 private:
  Result<std::vector<uint8_t>> message_of(const QueueEntry& entry) const;
  void send(QueueEntry& entry, std::vector<uint8_t> submap);
  void on_answer(JobName name, const TransferResult& result);
  void on_refused(QueueEntry& entry, const std::string& reason);
  void leave_for_next_start(QueueEntry& entry);

  Bus& bus_;
  QueuedWindows& windows_;
  int64_t retry_us_;
  ChunkSender sender_;
  std::string problem_;
  int published_ = 0;
  bool finishing_ = false;
};

}  // namespace rumi::ruminator
