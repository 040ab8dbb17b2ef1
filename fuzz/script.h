// SPDX-License-Identifier: BSD-3-Clause
// An input for a node: several messages, and the time that passes between them. Message by message so that states are
// reached, and so that a mutation of one leaves the others whole.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bus/process/process.h"
#include "bus/transport/memory_bus.h"
#include "fuzz/target.h"
#include "lcmtypes/rumi/map_request_t.hpp"

namespace rumi::fuzz {

// On the wire of the fuzzer: kind, length (two bytes, little endian), that many bytes.
struct Event {
  // Kinds below kFirstOther are a message on the channel of that number.
  static constexpr uint8_t kFirstOther = 0x40;
  static constexpr uint8_t kTime = 0x40;     // byte 0: 2^n ms pass
  static constexpr uint8_t kPayload = 0x41;  // byte 0: chunk kind, byte 1: which request is answered, then the payload
  static constexpr uint8_t kPicture = 0x42;  // byte 0: the number of a picture of the target's own
  static constexpr uint8_t kFinish = 0x43;
  uint8_t kind = 0;
  Bytes bytes;
};
using Script = std::vector<Event>;

Script parse_script(View input);
Bytes to_bytes(const Script& script);

// Changes one event, or puts in, takes out, repeats or moves one; those put in are from the seeds of the target.
size_t mutate_script(uint8_t* data, size_t size, size_t max_size, unsigned seed);

struct Stage {
  MemoryBus* bus = nullptr;
  Node* node = nullptr;
  std::vector<std::string> channels;  // by number
  std::string chunk_channel;          // of payloads, which come in chunks that are whole and have the right checksum
  void (*picture)(MemoryBus& bus, int number) = nullptr;
  bool finish = true;  // also where the script does not say so
};

// Plays it to the node, which afterwards finishes.
void play(const Script& script, const Stage& stage);

}  // namespace rumi::fuzz
