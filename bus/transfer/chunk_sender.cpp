// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <utility>

#include "bus/transfer/chunked_transfer.h"

namespace rumi {
namespace {

constexpr int kMinRepeats = 3;  // unanswered repeats before a transfer is given up, however far the clock jumped

}  // namespace

ChunkSender::ChunkSender(Bus& bus, std::string data_channel, std::string ack_channel, std::string sender_name,
                         const TransferOptions& options)
    : bus_(bus), data_channel_(std::move(data_channel)), name_(std::move(sender_name)), options_(options) {
  options_.chunk_bytes = std::clamp(options_.chunk_bytes, kMinChunkBytes, kMaxChunkBytes);
  options_.window_chunks = std::max(options_.window_chunks, 1);
  bus_.subscribe<chunk_ack_t>(ack_channel, {.capacity = 256, .drop = DropPolicy::kDropOldest},
                              [this](const chunk_ack_t& ack) { on_ack(ack); });
}

int64_t ChunkSender::send(const std::string& receiver, int8_t kind, int32_t request_id, std::vector<uint8_t> payload,
                          DoneHandler done, std::optional<int64_t> checksum) {
  Transfer transfer;
  // Numbers do not begin at 1: after a restart under the same name the receiver must not take a transfer for an earlier
  // one.
  transfer.id = last_id_ = std::max(last_id_ + 1, bus_.now_us());
  transfer.receiver = receiver;
  transfer.done = std::move(done);
  if (static_cast<int64_t>(payload.size()) > options_.max_payload_bytes) {
    oversized_.push_back(std::move(transfer));
    return last_id_;
  }
  transfer.kind = kind;
  transfer.request_id = request_id;
  transfer.checksum = checksum ? *checksum : static_cast<int64_t>(crc32_z(0, payload.data(), payload.size()));
  const int64_t chunks = (static_cast<int64_t>(payload.size()) + options_.chunk_bytes - 1) / options_.chunk_bytes;
  transfer.count = static_cast<int32_t>(std::max<int64_t>(1, chunks));
  transfer.payload = std::move(payload);
  std::deque<Transfer>& queue = queues_[receiver];
  queue.push_back(std::move(transfer));
  if (queue.size() == 1) start(queue.front());
  return last_id_;
}

void ChunkSender::start(Transfer& transfer) {
  transfer.last_news_us = bus_.now_us();
  send_window(transfer);
}

void ChunkSender::send_window(Transfer& transfer) {
  const int32_t end = std::min(transfer.count, transfer.acknowledged + options_.window_chunks);
  while (transfer.next_to_send < end) send_chunk(transfer, transfer.next_to_send++);
}

void ChunkSender::send_chunk(Transfer& transfer, int32_t index) {
  const int64_t begin = static_cast<int64_t>(index) * options_.chunk_bytes;
  const int64_t end = std::min<int64_t>(begin + options_.chunk_bytes, static_cast<int64_t>(transfer.payload.size()));
  chunk_t chunk;
  chunk.utime = bus_.now_us();
  chunk.sender = name_;
  chunk.receiver = transfer.receiver;
  chunk.transfer_id = transfer.id;
  chunk.request_id = transfer.request_id;
  chunk.kind = transfer.kind;
  chunk.index = index;
  chunk.count = transfer.count;
  chunk.total_size = static_cast<int64_t>(transfer.payload.size());
  chunk.checksum = transfer.checksum;
  chunk.data.assign(transfer.payload.begin() + begin, transfer.payload.begin() + end);
  chunk.size = static_cast<int32_t>(chunk.data.size());
  bus_.publish(data_channel_, chunk);
  transfer.last_sent_us = chunk.utime;
}

void ChunkSender::on_ack(const chunk_ack_t& ack) {
  if (ack.sender != name_) return;
  const auto found = std::find_if(queues_.begin(), queues_.end(), [&](const auto& item) {
    return item.second.front().id == ack.transfer_id && (item.first.empty() || item.first == ack.receiver);
  });
  if (found == queues_.end()) return;
  Transfer& transfer = found->second.front();
  transfer.last_news_us = bus_.now_us();
  transfer.repeats = 0;
  if (ack.status != chunk_ack_t::PARTIAL) {
    ++acknowledged_;
    finish(found->first, {ack.transfer_id, ack.status == chunk_ack_t::COMPLETE, ack.reason, ack.revision});
    return;
  }
  const int32_t before = transfer.acknowledged;
  transfer.acknowledged = std::max(before, std::clamp(ack.next_index, 0, transfer.count));
  acknowledged_ += transfer.acknowledged - before;
  // Chunks that were acknowledged before are sent as well: the receiver may have been started anew.
  int sent = 0;
  for (const int32_t index : ack.missing) {
    if (index < 0 || index >= transfer.next_to_send) continue;
    if (++sent > options_.window_chunks) break;
    send_chunk(transfer, index);
  }
  send_window(transfer);
}

void ChunkSender::finish(const std::string& receiver, const TransferResult& result) {
  const auto queue = queues_.find(receiver);
  const DoneHandler done = std::move(queue->second.front().done);
  queue->second.pop_front();
  if (queue->second.empty())
    queues_.erase(queue);
  else
    start(queue->second.front());
  if (done) done(result);  // called last, because it may send the next payload
}

// Calls `done` for payloads that were too large. send() does not call it: its caller may not be ready for the answer
// yet.
void ChunkSender::refuse_oversized() {
  const std::string why =
      fmt::format("it is larger than {} bytes, the most that is sent at once", options_.max_payload_bytes);
  for (const Transfer& transfer : std::exchange(oversized_, {}))
    if (transfer.done) transfer.done({transfer.id, false, why, 0});
}

void ChunkSender::tick(int64_t now_us) {
  refuse_oversized();
  std::vector<std::string> given_up;
  for (auto& [receiver, queue] : queues_) {
    Transfer& transfer = queue.front();
    // If the clock went back, the waiting times begin anew: else nothing would be sent until it has caught up.
    const bool went_back = now_us < transfer.last_sent_us || now_us < transfer.last_news_us;
    if (went_back) transfer.last_news_us = transfer.last_sent_us = now_us;
    if (now_us - transfer.last_news_us >= options_.give_up_us && transfer.repeats >= kMinRepeats) {
      given_up.push_back(receiver);
    } else if (now_us - std::max(transfer.last_news_us, transfer.last_sent_us) >= options_.retry_us) {
      ++transfer.repeats;
      send_chunk(transfer, std::min(transfer.acknowledged, transfer.count - 1));
      transfer.last_sent_us = now_us;
    }
  }
  for (const std::string& receiver : given_up) {
    const std::string who = receiver.empty() ? "anyone" : receiver;
    const double seconds = 1e-6 * static_cast<double>(options_.give_up_us);
    finish(receiver,
           {queues_.at(receiver).front().id, false, fmt::format("no answer from {} for {} s", who, seconds), 0});
  }
}

int ChunkSender::pending() const {
  size_t count = oversized_.size();
  for (const auto& [receiver, queue] : queues_) count += queue.size();
  return static_cast<int>(count);
}

}  // namespace rumi
