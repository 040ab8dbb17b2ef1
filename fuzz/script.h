// SPDX-License-Identifier: BSD-3-Clause
// An input for a node: several messages, and the time that passes between them. A sequence of messages reaches more
// states than one message does, and a mutation of one of them leaves the others valid.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bus/process/process.h"
#include "bus/transport/memory_bus.h"
#include "fuzz/target.h"
#include "lcmtypes/rumi/map_request_t.hpp"

namespace rumi::fuzz {

// An event of a script. Its bytes in an input: kind, length (two bytes, little endian), that many bytes.
struct Event {
  // A kind below kFirstOther is a message on the channel with this number (see Stage::channels).
  static constexpr uint8_t kFirstOther = 0x40;
  static constexpr uint8_t kTime = 0x40;     // byte 0: n; 2^n ms pass
  static constexpr uint8_t kPayload = 0x41;  // kind of chunk, request that it answers (0: the latest), then payload
  static constexpr uint8_t kPicture = 0x42;  // byte 0: number of one of the target's own pictures
  static constexpr uint8_t kFinish = 0x43;
  uint8_t kind = 0;
  Bytes bytes;
};
using Script = std::vector<Event>;

Script parse_script(View input);
Bytes to_bytes(const Script& script);

// A Mutator for scripts. Each of its few changes mutates, inserts, removes, repeats or swaps events. Inserted events
// are taken from the target's seeds.
size_t mutate_script(uint8_t* data, size_t size, size_t max_size, unsigned seed);

struct Stage {
  MemoryBus* bus = nullptr;
  Node* node = nullptr;
  std::vector<std::string> channels;  // an event's kind is the index
  std::string chunk_channel;          // for payloads: each is sent as one chunk with the right checksum
  void (*picture)(MemoryBus& bus, int number) = nullptr;
  bool finish = true;  // finish the node after the script, unless the script has done so
};

// Plays the script to the node, asks for its status, and lets three more seconds pass.
void play(const Script& script, const Stage& stage);

}  // namespace rumi::fuzz
