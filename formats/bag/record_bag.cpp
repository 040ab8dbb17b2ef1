// SPDX-License-Identifier: BSD-3-Clause
#include "formats/bag/record_bag.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>

namespace rumi {
namespace {

constexpr int64_t kMostMessageBytes = int64_t{512} << 20;

uint32_t crc_of(std::span<const uint8_t> bytes) {
  return static_cast<uint32_t>(crc32_z(crc32_z(0, nullptr, 0), bytes.data(), bytes.size()));
}

}  // namespace

void RecordBag::scan(const Visit& visit) {
  visit_ = visit;
  const int64_t size = bytes_.size();
  int64_t at = begin(bytes_), last = 0;
  if (at == kNoRecord) {
    at = find_record(bytes_, 0);
    count_damage(0, at, at, "it does not begin as a bag does");
  }
  while (at < size && !is_enough_) {
    const int64_t next = take(bytes_, at, BagPlace::kInFile);
    if (next > at) {
      last = at;
      at = next;
      continue;
    }
    // The length of the last record may itself be damaged.
    int64_t found = find_record(bytes_, (next == kNoEnd ? at : last) + 1);
    if (found == at) found = find_record(bytes_, at + 1);
    const int64_t from = found < at ? last : at;
    count_damage(from, found, found - from, "no whole record begins here");
    last = at = found;
  }
  visit_ = nullptr;
}

void RecordBag::count_damage(int64_t from, int64_t to, int64_t lost, const std::string& what) {
  if (to >= bytes_.size()) {
    damage_.at_end = fmt::format(
        "the {} bytes from byte {} on are no whole record: the file was cut off, or is still being recorded",
        bytes_.size() - from, from);
    return;
  }
  if (damage_.places++ == 0)
    damage_.first = fmt::format("{}: at byte {}: {}; it goes on at byte {}", name_, from, what, to);
  damage_.bytes += std::max<int64_t>(0, lost);
}

int64_t RecordBag::take_chunk(int64_t at, int64_t stored_bytes, Compression compression, uint32_t crc) {
  const int64_t rest = bytes_.size() - at;
  // A chunk that is still being recorded has no length yet.
  const bool has_length = stored_bytes > 0 && stored_bytes <= rest;
  const int64_t length = has_length ? stored_bytes : rest;
  Decompressed chunk = decompress(bytes_, at, length, compression);
  const bool is_garbled = crc != kNoCrc && chunk.is_whole && crc != crc_of(chunk.bytes);
  const bool ends_file = !has_length && chunk.is_cut_off;
  const int64_t next = ends_file        ? bytes_.size()
                       : has_length     ? at + stored_bytes
                       : chunk.is_whole ? at + chunk.stored_bytes
                                        : kNoEnd;
  const auto number = static_cast<int32_t>(chunks_.size());
  chunks_.push_back({at, length, compression});
  open_chunk_ = number;
  open_bytes_ = std::move(chunk.bytes);
  MemoryBytes memory(open_bytes_);
  int64_t inside = 0;
  for (int64_t end = memory.size(); inside < end && !is_enough_;) {
    const int64_t after = take(memory, inside, number);
    if (after <= inside) break;
    inside = after;
  }
  if (next == kNoEnd || is_enough_) return next;
  // Records before the damage are good, as in a file that was cut off.
  const double taken = memory.size() == 0 ? 0 : static_cast<double>(inside) / static_cast<double>(memory.size());
  const auto lost = length - static_cast<int64_t>(taken * static_cast<double>(std::min(length, chunk.stored_bytes)));
  if (!chunk.is_whole || inside < memory.size())
    count_damage(at, next, lost, "a chunk is broken");
  else if (is_garbled)
    count_damage(at, next, 0, "the checksum of a chunk is wrong, so some of it may be damaged");
  return next;
}

void RecordBag::take_message(ByteSource& source, BagMessage* message) {
  const auto known = connections_.find(message->connection);
  if (known != connections_.end() && !known->second.is_read()) {
    ++other_messages_[message->connection];
    return;
  }
  const auto count = static_cast<size_t>(std::min<int64_t>(message->place.bytes, kHeadBytes));
  if (source.read(message->place.at, {message->head.data(), count})) is_enough_ = !visit_(*message);
}

bool RecordBag::read(const BagPlace& place, std::vector<uint8_t>* bytes) {
  if (place.bytes < 0 || place.bytes > kMostMessageBytes) return false;
  if (place.chunk == BagPlace::kInFile) {
    if (place.bytes > bytes_.size()) return false;
    bytes->resize(static_cast<size_t>(place.bytes));
    return bytes_.read(place.at, *bytes);
  }
  if (open_chunk_ != place.chunk) {
    const Chunk& chunk = chunks_[static_cast<size_t>(place.chunk)];
    open_chunk_ = place.chunk;
    open_bytes_ = decompress(bytes_, chunk.at, chunk.stored_bytes, chunk.compression).bytes;
  }
  MemoryBytes memory(open_bytes_);
  if (place.bytes > memory.size()) return false;
  bytes->resize(static_cast<size_t>(place.bytes));
  return memory.read(place.at, *bytes);
}

}  // namespace rumi
