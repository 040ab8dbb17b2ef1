// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <utility>

#include "base/running/failures.h"
#include "base/running/log.h"
#include "bus/transfer/chunked_transfer.h"

namespace rumi {
namespace {

constexpr size_t kMaxOpen = 64;    // transfers under way at a time, so that garbage cannot fill the memory
constexpr size_t kMaxRecent = 64;  // finished transfers whose answer is kept, to be sent again
constexpr int kMaxRestarts = 3;    // of one transfer, after a wrong checksum
constexpr int kMinRequests = 3;    // unanswered requests before a transfer is given up, however far the clock jumped

// True if the numbers of the chunk fit each other: all chunks but the last have one size, and together they make
// total_size.
bool is_plausible(const chunk_t& c, int64_t max_payload_bytes) {
  if (c.count < 1 || c.index < 0 || c.index >= c.count) return false;
  if (c.total_size < 0 || c.total_size > max_payload_bytes) return false;
  if (c.size != static_cast<int32_t>(c.data.size())) return false;
  if (c.count == 1) return c.size == c.total_size;
  if (c.size < 1) return false;
  if (c.index == c.count - 1) {
    const int64_t others = c.total_size - c.size;
    return others >= std::max<int64_t>(c.size, kMinChunkBytes) * (c.count - 1) && others % (c.count - 1) == 0;
  }
  if (c.size < kMinChunkBytes) return false;
  const int64_t before_last = static_cast<int64_t>(c.size) * (c.count - 1);
  return before_last < c.total_size && c.total_size <= before_last + c.size;
}

bool same_transfer(const chunk_t& a, const chunk_t& b) {
  return a.sender == b.sender && a.transfer_id == b.transfer_id && a.count == b.count && a.total_size == b.total_size &&
         a.checksum == b.checksum && a.kind == b.kind && a.request_id == b.request_id;
}

}  // namespace

ChunkReceiver::ChunkReceiver(Bus& bus, std::string data_channel, std::string ack_channel, std::string receiver_name,
                             bool accept_unaddressed, PayloadHandler handler, const TransferOptions& options)
    : bus_(bus),
      ack_channel_(std::move(ack_channel)),
      name_(std::move(receiver_name)),
      accept_unaddressed_(accept_unaddressed),
      handler_(std::move(handler)),
      options_(options) {
  options_.window_chunks = std::max(options_.window_chunks, 1);
  options_.max_payload_bytes = std::min(options_.max_payload_bytes, options_.max_held_bytes);
  // The queue has room for the windows of several senders.
  bus_.subscribe<chunk_t>(data_channel, {.capacity = 256, .drop = DropPolicy::kDropNewest},
                          [this](const chunk_t& chunk) { on_chunk(chunk); });
}

void ChunkReceiver::on_chunk(const chunk_t& chunk) {
  if (chunk.receiver.empty() ? !accept_unaddressed_ : chunk.receiver != name_) return;
  if (!is_plausible(chunk, options_.max_payload_bytes)) {
    log_debug("chunk {} of {} from {} ({} of {} bytes) makes no sense", chunk.index, chunk.count, chunk.sender,
              chunk.size, chunk.total_size);
    return;
  }
  for (Finished& finished : recent_) {
    if (!same_transfer(finished.header, chunk)) continue;
    finished.answer.utime = bus_.now_us();
    bus_.publish(ack_channel_, finished.answer);
    return;
  }
  const Id id{chunk.sender, chunk.transfer_id};
  Assembly& assembly = assembly_of(id, chunk);
  const int64_t now_us = bus_.now_us();
  assembly.last_chunk_us = now_us;
  assembly.requests = 0;
  const bool is_new = assembly.pieces.emplace(chunk.index, chunk.data).second;
  if (is_new) {
    assembly.held_bytes += chunk.size;
    held_bytes_ += chunk.size;
    make_room(kMaxOpen, id);
  }
  while (assembly.pieces.contains(assembly.next_index)) ++assembly.next_index;
  if (assembly.next_index == chunk.count) {
    complete(id);
    return;
  }
  // Chunks are acknowledged after half a window, so that the sender need not stop. A repeated chunk means that our last
  // answer was lost; one answer to a burst of them is enough.
  const bool answer_was_lost = !is_new && now_us - assembly.last_ack_us >= options_.retry_us / 3;
  if (++assembly.unacknowledged >= std::max(1, options_.window_chunks / 2) || answer_was_lost)
    acknowledge(assembly, assembly.pieces.rbegin()->first);
}

ChunkReceiver::Assembly& ChunkReceiver::assembly_of(const Id& id, const chunk_t& chunk) {
  const auto found = open_.find(id);
  // If the transfer's number now stands for another payload, the sender was restarted, and its old chunks are
  // worthless.
  if (found != open_.end() && same_transfer(found->second.header, chunk)) return found->second;
  if (found != open_.end()) forget(found);
  make_room(kMaxOpen - 1, id);
  Assembly& assembly = open_[id];
  assembly.header = chunk;
  assembly.header.data.clear();
  assembly.header.size = 0;
  return assembly;
}

void ChunkReceiver::forget(std::map<Id, Assembly>::iterator assembly) {
  held_bytes_ -= assembly->second.held_bytes;
  open_.erase(assembly);
}

// Removes the transfers that had no chunk for longest, until there is room. `but_for` stays: one payload always fits
// (see is_plausible()).
void ChunkReceiver::make_room(size_t max_open, const Id& but_for) {
  while (open_.size() > max_open || held_bytes_ > options_.max_held_bytes) {
    auto oldest = open_.end();
    for (auto it = open_.begin(); it != open_.end(); ++it)
      if (it->first != but_for && (oldest == open_.end() || it->second.last_chunk_us < oldest->second.last_chunk_us))
        oldest = it;
    if (oldest == open_.end()) return;
    // Logged once, then only counted: a flood of transfers must not fill the log.
    if (dropped_++ == 0)
      log_warning("{} of {} bytes from {} are dropped: {} transfers with {} bytes are under way, {} with {} may be",
                  oldest->second.held_bytes, oldest->second.header.total_size, oldest->first.first, open_.size(),
                  held_bytes_, kMaxOpen, options_.max_held_bytes);
    forget(oldest);
  }
}

void ChunkReceiver::complete(const Id& id) {
  Assembly& assembly = open_.at(id);
  std::vector<uint8_t> bytes;
  for (const auto& [index, piece] : assembly.pieces) bytes.insert(bytes.end(), piece.begin(), piece.end());
  const bool intact = static_cast<int64_t>(bytes.size()) == assembly.header.total_size &&
                      static_cast<int64_t>(crc32_z(0, bytes.data(), bytes.size())) == assembly.header.checksum;
  if (!intact && ++assembly.restarts <= kMaxRestarts) {
    log_warning("{} bytes from {} arrived damaged and are asked for again", bytes.size(), id.first);
    assembly.pieces.clear();
    held_bytes_ -= std::exchange(assembly.held_bytes, 0);
    assembly.next_index = 0;
    acknowledge(assembly, assembly.header.count);
    return;
  }
  const chunk_t header = std::move(assembly.header);
  forget(open_.find(id));
  Verdict verdict{false, "the checksum does not match", 0};
  if (intact) {
    try {
      verdict = handler_({header.sender, header.kind, header.request_id, std::move(bytes)});
    } catch (const std::exception& e) {
      verdict = {false, reason_of(e), 0};
    }
  }
  chunk_ack_t ack;
  ack.utime = bus_.now_us();
  ack.sender = header.sender;
  ack.receiver = name_;
  ack.transfer_id = header.transfer_id;
  ack.status = verdict.ok ? chunk_ack_t::COMPLETE : chunk_ack_t::REJECTED;
  ack.next_index = header.count;
  ack.nmissing = 0;
  ack.reason = verdict.reason;
  ack.revision = verdict.revision;
  bus_.publish(ack_channel_, ack);
  recent_.push_back({header, ack});
  if (recent_.size() > kMaxRecent) recent_.pop_front();
}

// Acknowledges the chunks below next_index and asks for those that are missing below `end`, at most for one window.
void ChunkReceiver::acknowledge(Assembly& assembly, int32_t end) {
  chunk_ack_t ack;
  ack.utime = bus_.now_us();
  ack.sender = assembly.header.sender;
  ack.receiver = name_;
  ack.transfer_id = assembly.header.transfer_id;
  ack.status = chunk_ack_t::PARTIAL;
  ack.next_index = assembly.next_index;
  end = std::min(end, assembly.next_index + options_.window_chunks);
  for (int32_t i = assembly.next_index; i < end; ++i)
    if (!assembly.pieces.contains(i)) ack.missing.push_back(i);
  ack.nmissing = static_cast<int32_t>(ack.missing.size());
  ack.revision = 0;
  bus_.publish(ack_channel_, ack);
  assembly.last_ack_us = ack.utime;
  assembly.unacknowledged = 0;
}

void ChunkReceiver::tick(int64_t now_us) {
  for (auto it = open_.begin(); it != open_.end();) {
    Assembly& assembly = it->second;
    // If the clock went back, the waiting times begin anew: else nothing would be sent until it has caught up.
    if (now_us < assembly.last_chunk_us || now_us < assembly.last_ack_us)
      assembly.last_chunk_us = assembly.last_ack_us = now_us;
    if (now_us - assembly.last_chunk_us >= options_.give_up_us && assembly.requests >= kMinRequests) {
      forget(it++);
      continue;
    }
    if (now_us - std::max(assembly.last_chunk_us, assembly.last_ack_us) >= options_.retry_us) {
      ++assembly.requests;
      // Asks up to the last chunk, although some may not have been sent yet: the sender knows which.
      acknowledge(assembly, assembly.header.count);
    }
    ++it;
  }
}

std::optional<std::pair<int, int>> ChunkReceiver::progress(int32_t request_id) const {
  for (const auto& [id, assembly] : open_)
    if (assembly.header.request_id == request_id)
      return std::pair(static_cast<int>(assembly.pieces.size()), assembly.header.count);
  for (const Finished& finished : recent_)
    if (finished.header.request_id == request_id) return std::pair(finished.header.count, finished.header.count);
  return std::nullopt;
}

}  // namespace rumi
