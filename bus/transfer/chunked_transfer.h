// SPDX-License-Identifier: BSD-3-Clause
// Sends large payloads in chunks over a bus that may lose, repeat or reorder anything. Chunks are numbered,
// acknowledged and requested again, and each payload has a checksum. One ChunkSender per pair of channels serves any
// number of transfers, one at a time per receiver name.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bus/transport/bus.h"
#include "lcmtypes/rumi/chunk_ack_t.hpp"
#include "lcmtypes/rumi/chunk_t.hpp"

namespace rumi {

// Smaller chunks (except the last of a transfer) would take more memory to manage than they carry; larger ones do not
// fit into one LCM datagram.
inline constexpr int kMinChunkBytes = 1000, kMaxChunkBytes = 60'000;

struct TransferOptions {
  int chunk_bytes = 48000;          // kMinChunkBytes .. kMaxChunkBytes
  int window_chunks = 16;           // chunks sent ahead of the last acknowledged one
  int64_t retry_us = 300'000;       // without news for so long, the sender repeats a chunk and the receiver asks again
  int64_t give_up_us = 60'000'000;  // without any news for so long, the sender reports failure and the receiver forgets
  int64_t max_payload_bytes = int64_t{4} << 30;  // larger payloads are neither sent nor taken
  int64_t max_held_bytes = int64_t{4} << 30;     // bytes of all incomplete transfers together; beyond it, the receiver
                                                 // drops the one that has been idle for longest
};

struct TransferResult {
  int64_t transfer_id = 0;
  bool ok = false;
  std::string reason;    // when not ok
  int64_t revision = 0;  // the receiver's answer (see chunk_ack_t)
};

class ChunkSender {
 public:
  using DoneHandler = std::function<void(const TransferResult&)>;

  ChunkSender(Bus& bus, std::string data_channel, std::string ack_channel, std::string sender_name,
              const TransferOptions& options = {});

  // Queues a payload (may be empty); transfers to the same receiver go one after another. Returns the transfer's id. A
  // payload above max_payload_bytes is not sent: `done` reports that at the next tick. `checksum` is the payload's
  // CRC-32; it is computed if it is not given.
  int64_t send(const std::string& receiver, int8_t kind, int32_t request_id, std::vector<uint8_t> payload,
               DoneHandler done, std::optional<int64_t> checksum = {});
  void tick(int64_t now_us);
  // Returns the number of payloads that are not acknowledged yet.
  int pending() const;
  // Returns the number of chunks acknowledged so far, plus that of payloads that were accepted or refused.
  int64_t acknowledged() const { return acknowledged_; }

 private:
  struct Transfer {
    int64_t id = 0;
    std::string receiver;
    int8_t kind = 0;
    int32_t request_id = 0;
    std::vector<uint8_t> payload;
    int64_t checksum = 0;
    int32_t count = 0;
    int32_t next_to_send = 0;
    int32_t acknowledged = 0;  // all chunks below this index are acknowledged
    int repeats = 0;           // since the last acknowledgement
    int64_t last_news_us = 0, last_sent_us = 0;
    DoneHandler done;
  };
  void on_ack(const chunk_ack_t& ack);
  void start(Transfer& transfer);
  void send_window(Transfer& transfer);
  void send_chunk(Transfer& transfer, int32_t index);
  void finish(const std::string& receiver, const TransferResult& result);
  void refuse_oversized();
  Bus& bus_;
  std::string data_channel_, name_;
  TransferOptions options_;
  int64_t last_id_ = 0, acknowledged_ = 0;
  std::map<std::string, std::deque<Transfer>> queues_;  // by receiver; none is empty, the first in each is under way
  std::vector<Transfer> oversized_;                     // without their payloads, to be refused at the next tick
};

class ChunkReceiver {
 public:
  struct Payload {
    std::string sender;
    int8_t kind = 0;
    int32_t request_id = 0;
    std::vector<uint8_t> bytes;
  };
  struct Verdict {
    bool ok = true;
    std::string reason;    // when not ok
    int64_t revision = 0;  // passed to the sender
  };
  // Called once per completed transfer, before it is acknowledged: return only when the payload is safely stored.
  using PayloadHandler = std::function<Verdict(const Payload&)>;

  // accept_unaddressed: also take chunks whose receiver field is empty.
  ChunkReceiver(Bus& bus, std::string data_channel, std::string ack_channel, std::string receiver_name,
                bool accept_unaddressed, PayloadHandler handler, const TransferOptions& options = {});
  void tick(int64_t now_us);
  // Returns (chunks received, chunks in all) of the transfer that this request started; nullopt before its first chunk.
  std::optional<std::pair<int, int>> progress(int32_t request_id) const;
  // Returns how many incomplete transfers were dropped so far, to make room for others.
  int64_t dropped() const { return dropped_; }

 private:
  struct Assembly {
    chunk_t header;                                  // the first chunk that came, without its data
    std::map<int32_t, std::vector<uint8_t>> pieces;  // by index; grows with what arrives, not with what is announced
    int32_t next_index = 0;                          // all chunks below this index have arrived
    int32_t unacknowledged = 0;
    int restarts = 0;  // because of a wrong checksum
    int requests = 0;  // requests for missing chunks since the last chunk came
    int64_t last_chunk_us = 0, last_ack_us = 0;
    int64_t held_bytes = 0;
  };
  struct Finished {
    chunk_t header;
    chunk_ack_t answer;  // sent again whenever a chunk of this transfer comes again
  };
  using Id = std::pair<std::string, int64_t>;  // name of the sender, id of the transfer
  void on_chunk(const chunk_t& chunk);
  Assembly& assembly_of(const Id& id, const chunk_t& chunk);
  void forget(std::map<Id, Assembly>::iterator assembly);
  void make_room(size_t max_open, const Id& but_for);
  void complete(const Id& id);
  void acknowledge(Assembly& assembly, int32_t end);
  Bus& bus_;
  std::string ack_channel_, name_;
  bool accept_unaddressed_;
  PayloadHandler handler_;
  TransferOptions options_;
  std::map<Id, Assembly> open_;
  int64_t held_bytes_ = 0, dropped_ = 0;
  std::deque<Finished> recent_;
};

}  // namespace rumi
