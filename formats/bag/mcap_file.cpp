// SPDX-License-Identifier: BSD-3-Clause
// Reads MCAP (mcap.dev/spec), ROS 2's usual bag: each record is an opcode, a length of 8 bytes, and as many bytes.
#include <algorithm>
#include <cstring>
#include <string_view>

#include "formats/bag/foxglove_messages.h"
#include "formats/bag/record_bag.h"

namespace rumi {
namespace {

constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);
constexpr int64_t kHeaderBytes = 9, kMessageHeadBytes = 22;
constexpr int64_t kMostDefinitionBytes = 4 << 20;
enum Op : uint8_t { kFooter = 2, kSchema = 3, kChannel = 4, kMessage = 5, kChunk = 6, kLastKnown = 0x0F };
constexpr uint8_t kFirstPrivate = 0x80;

struct Record {
  uint8_t op = 0;
  int64_t at = 0, bytes = 0;  // position and size of its body
};

// Reads the header of the record at `at`; nullopt if there is none. The record's body may be cut off: its length is not
// checked against the file.
std::optional<Record> read_record(ByteSource& source, int64_t at) {
  std::array<uint8_t, kHeaderBytes> header;
  if (!source.read(at, header)) return std::nullopt;
  const auto bytes = little_endian<int64_t>(std::span(header).subspan(1));
  const bool is_known = header[0] >= kFooter - 1 && (header[0] <= kLastKnown || header[0] >= kFirstPrivate);
  constexpr int64_t kMost = int64_t{1} << 60;
  if (!is_known || bytes < 0 || bytes > kMost) return std::nullopt;
  return Record{header[0], at + kHeaderBytes, bytes};
}

// Reads one field after the other; missing ones are 0 or empty.
class Fields {
 public:
  explicit Fields(std::span<const uint8_t> bytes) : bytes_(bytes) {}
  bool is_ok() const { return is_ok_; }
  uint16_t id() { return number<uint16_t>(); }
  template <class Number>
  Number number() {
    const auto taken = take(sizeof(Number));
    return taken.size() == sizeof(Number) ? little_endian<Number>(taken) : Number{};
  }
  std::string text() {
    const auto taken = take(number<uint32_t>());
    return {taken.begin(), taken.end()};
  }

 private:
  std::span<const uint8_t> take(size_t count) {
    is_ok_ = is_ok_ && count <= bytes_.size();
    if (!is_ok_) return {};
    const auto taken = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return taken;
  }
  std::span<const uint8_t> bytes_;
  bool is_ok_ = true;
};

struct ChunkHead {
  uint32_t crc = 0;
  Compression compression = Compression::kNone;
  int64_t at = 0, stored_bytes = 0;
};

// Returns nullopt if its two lengths do not fit each other, or its compression is not known.
std::optional<ChunkHead> read_chunk_head(ByteSource& source, const Record& record) {
  constexpr int64_t kBeforeName = 28, kLongestName = 16;  // bytes of times, size and crc; of the compression's name
  std::array<uint8_t, kBeforeName + 4 + kLongestName + 8> head{};
  const int64_t left = std::max<int64_t>(0, source.size() - record.at);
  const auto count = static_cast<size_t>(std::min<int64_t>(left, head.size()));
  if (!source.read(record.at, std::span(head).first(count))) return std::nullopt;
  Fields in(std::span<const uint8_t>(head).subspan(kBeforeName - 4, count - std::min<size_t>(count, kBeforeName - 4)));
  ChunkHead chunk;
  chunk.crc = in.number<uint32_t>();
  const std::string name = in.text();
  chunk.stored_bytes = in.number<int64_t>();
  const int64_t head_bytes = kBeforeName + 4 + static_cast<int64_t>(name.size()) + 8;
  const std::optional<Compression> compression = compression_named(name);
  if (!in.is_ok() || !compression || chunk.stored_bytes != record.bytes - head_bytes) return std::nullopt;
  chunk.compression = *compression;
  chunk.at = record.at + head_bytes;
  return chunk;
}

class McapFile : public RecordBag {
 public:
  using RecordBag::RecordBag;

 protected:
  int64_t begin(ByteSource& file) override {
    return is_magic(file, 0) ? static_cast<int64_t>(kMagic.size()) : kNoRecord;
  }

  int64_t take(ByteSource& source, int64_t at, int32_t chunk) override {
    const bool is_end = chunk == BagPlace::kInFile && at == source.size() - static_cast<int64_t>(kMagic.size());
    if (is_end && is_magic(source, at)) return source.size();
    const std::optional<Record> record = read_record(source, at);
    if (!record) return kNoRecord;
    if (record->op == kChunk && chunk == BagPlace::kInFile) return take_chunk_record(source, *record);
    const int64_t next = record->at + record->bytes;
    if (next > source.size()) return kNoRecord;
    const bool is_good = record->op == kMessage                            ? take_message_record(source, *record, chunk)
                         : record->op == kSchema || record->op == kChannel ? take_definition(source, *record)
                                                                           : true;
    return is_good ? next : kNoRecord;
  }

  int64_t find_record(ByteSource& file, int64_t from) override {
    constexpr int64_t kPieceBytes = 1 << 20;
    std::vector<uint8_t> piece;
    for (int64_t at = from; at < file.size(); at += kPieceBytes) {
      piece.resize(static_cast<size_t>(std::min(file.size() - at, kPieceBytes + kHeaderBytes)));
      if (!file.read(at, piece)) break;
      for (size_t i = 0; i + kHeaderBytes <= piece.size(); ++i) {
        const bool has_op = piece[i] == kChunk || piece[i] == kMessage;
        const bool is_shorter_than_a_terabyte = piece[i + 6] == 0 && piece[i + 7] == 0 && piece[i + 8] == 0;
        if (!has_op || !is_shorter_than_a_terabyte) continue;
        if (const int64_t found = at + static_cast<int64_t>(i); seems_record(file, found)) return found;
      }
    }
    return file.size();
  }

 private:
  static bool is_magic(ByteSource& file, int64_t at) {
    std::array<uint8_t, kMagic.size()> bytes{};
    return file.read(at, bytes) && std::memcmp(bytes.data(), kMagic.data(), bytes.size()) == 0;
  }

  // True if a chunk or a message seems to begin here. A chunk is recognized by its two lengths, a message by its
  // channel and the record behind it.
  bool seems_record(ByteSource& file, int64_t at) const {
    const std::optional<Record> record = read_record(file, at);
    if (!record) return false;
    if (record->op == kChunk) return read_chunk_head(file, *record).has_value();
    std::array<uint8_t, 2> channel;
    const int64_t next = record->at + record->bytes;
    if (record->bytes < kMessageHeadBytes || next > file.size() || !file.read(record->at, channel)) return false;
    // As long as no connection is known, each channel is accepted: lost definitions come again at the end of the file.
    if (!connections().empty() && !knows(little_endian<uint16_t>(channel))) return false;
    const std::optional<Record> following = read_record(file, next);
    return next == file.size() || (following && following->at + following->bytes <= file.size());
  }

  int64_t take_chunk_record(ByteSource& source, const Record& record) {
    const std::optional<ChunkHead> chunk = read_chunk_head(source, record);
    if (!chunk || chunk->compression == Compression::kBz2) return kNoRecord;
    if (chunk->compression == Compression::kNone) return chunk->at;
    return take_chunk(chunk->at, chunk->stored_bytes, chunk->compression, chunk->crc);
  }

  bool take_message_record(ByteSource& source, const Record& record, int32_t chunk) {
    std::array<uint8_t, kMessageHeadBytes> head;
    if (record.bytes < kMessageHeadBytes || !source.read(record.at, head)) return false;
    Fields in(head);
    BagMessage message;
    message.connection = in.id();
    in.number<uint32_t>();  // sequence
    message.time_ns = in.number<int64_t>();
    message.place = {0, chunk, record.at + kMessageHeadBytes, record.bytes - kMessageHeadBytes};
    take_message(source, &message);
    return true;
  }

  bool take_definition(ByteSource& source, const Record& record) {
    if (record.bytes > kMostDefinitionBytes) return false;
    std::vector<uint8_t> bytes(static_cast<size_t>(record.bytes));
    if (!source.read(record.at, bytes)) return false;
    Fields in(bytes);
    const uint16_t id = in.id();
    if (record.op == kSchema) {
      schemas_[id] = type_named(in.text());
    } else {
      Channel& channel = channels_[id];
      channel.schema = in.id();
      channel.topic = in.text();
      channel.encoding = in.text();
    }
    name_connections();
    return in.is_ok();
  }

  // Makes a connection of each channel whose schema is known.
  void name_connections() {
    for (const auto& [id, channel] : channels_) {
      const auto schema = schemas_.find(channel.schema);
      if (schema == schemas_.end() && channel.schema != 0) continue;
      add_connection(id, connection_of(channel, schema == schemas_.end() ? "" : schema->second));
    }
  }

  struct Channel {
    uint16_t schema = 0;
    std::string topic, encoding;
  };
  static BagConnection connection_of(const Channel& channel, const std::string& type) {
    if (channel.encoding == "cdr") return {channel.topic, type, RosEncoding::kCdr};
    if (channel.encoding == "ros1") return {channel.topic, type, RosEncoding::kRos1};
    const std::string ros_type = ros_type_of_foxglove(type);
    if (!ros_type.empty() && channel.encoding == "protobuf") return {channel.topic, ros_type, RosEncoding::kProtobuf};
    if (!ros_type.empty() && channel.encoding == "json") return {channel.topic, ros_type, RosEncoding::kJson};
    return {channel.topic, channel.encoding + " " + type, RosEncoding::kOther};
  }

  std::map<uint16_t, std::string> schemas_;
  std::map<uint16_t, Channel> channels_;
};

}  // namespace

std::unique_ptr<BagFile> open_mcap_file(const std::string& file) { return std::make_unique<McapFile>(file); }

}  // namespace rumi
