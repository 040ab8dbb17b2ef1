// SPDX-License-Identifier: BSD-3-Clause
// Chunks to a receiver and acknowledgements to a sender, both with little memory.
#include "bus/transfer/chunked_transfer.h"
#include "fuzz/good_messages.h"

namespace rumi::fuzz {
namespace {

enum Channel : uint8_t { kData, kAck };
constexpr size_t kPayloadBytes = 5000;

// The sender and the receiver, as one node that play() can drive.
class Ends : public Node {
 public:
  explicit Ends(Bus& bus)
      : sender_(bus, "OUT", "OUT_ACK", "somebody", options()),
        receiver_(
            bus, "IN", "IN_ACK", "receiver", true,
            [](const ChunkReceiver::Payload& payload) {
              return ChunkReceiver::Verdict{.ok = payload.bytes.size() % 2 == 0, .reason = "odd", .revision = 1};
            },
            options()) {
    for (int i = 0; i < 3; ++i) sender_.send(i == 2 ? "other" : "", 0, i, Bytes(kPayloadBytes, 7), {});
  }
  void tick(int64_t now_us) override {
    sender_.tick(now_us);
    receiver_.tick(now_us);
    receiver_.progress(1);
  }
  NodeStatus status() override { return {}; }

 private:
  static TransferOptions options() {
    return {.chunk_bytes = 1000, .max_payload_bytes = 100'000, .max_held_bytes = 20'000};
  }
  ChunkSender sender_;
  ChunkReceiver receiver_;
};

void run(View input) {
  MemoryBus bus;
  Ends ends(bus);
  play(parse_script(input), {.bus = &bus, .node = &ends, .channels = {"IN", "OUT_ACK"}, .chunk_channel = "IN"});
}

Event chunk(int32_t index, int32_t count, size_t bytes) {
  chunk_t c{};
  c.sender = "somebody";
  c.transfer_id = 1000;
  c.request_id = 1;
  c.index = index;
  c.count = count;
  c.total_size = static_cast<int64_t>(bytes) * count;
  c.data.assign(bytes, 0);
  c.size = static_cast<int32_t>(bytes);
  c.checksum = 0x2EA5A2C2;  // wrong, so the receiver asks for the payload again
  return message(kData, c);
}

std::vector<Bytes> seeds() {
  chunk_ack_t lacks = good_ack(1, chunk_ack_t::PARTIAL);
  lacks.missing = {2, 4};
  lacks.nmissing = 2;
  const Script parts{chunk(0, 3, 1000), chunk(2, 3, 1000), pause(9), chunk(1, 3, 1000), pause(16)};
  const Script acks{message(kAck, lacks), pause(9), message(kAck, good_ack(1, chunk_ack_t::COMPLETE)),
                    message(kAck, good_ack(2, chunk_ack_t::REJECTED))};
  const Script whole{payload(0, lacks), payload(1, good_ack(3, 0))};
  return {to_bytes(parts), to_bytes(acks), to_bytes(whole)};
}

const Registered registered({"transfer", run, seeds, mutate_script});

}  // namespace
}  // namespace rumi::fuzz
