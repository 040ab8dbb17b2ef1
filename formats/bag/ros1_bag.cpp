// SPDX-License-Identifier: BSD-3-Clause
// Reads ROS 1's bags, format 2.0: wiki.ros.org/Bags/Format/2.0. A record is a header of fields "name=value" and data,
// each preceded by its length.
#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "formats/bag/record_bag.h"

namespace rumi {
namespace {

constexpr std::string_view kMagic = "#ROSBAG V2.0\n", kAnyMagic = "#ROS";
constexpr uint32_t kMostHeaderBytes = 64 << 10, kMostDefinitionBytes = 4 << 20;
constexpr size_t kLengthBytes = 4;
enum Op : uint8_t { kMessage = 2, kBagHeader = 3, kIndex = 4, kChunk = 5, kChunkInfo = 6, kConnection = 7 };

using RecordFields = std::map<std::string, std::string, std::less<>>;

// Reads fields "name=value", each preceded by its length. Returns false if the bytes are something else.
bool parse_fields(std::span<const uint8_t> bytes, RecordFields* fields) {
  while (!bytes.empty()) {
    if (bytes.size() < kLengthBytes) return false;
    const auto length = little_endian<uint32_t>(bytes);
    bytes = bytes.subspan(kLengthBytes);
    if (length > bytes.size()) return false;
    const std::string field(bytes.begin(), bytes.begin() + length);
    const size_t equals = field.find('=');
    if (equals == std::string::npos) return false;
    fields->insert_or_assign(field.substr(0, equals), field.substr(equals + 1));
    bytes = bytes.subspan(length);
  }
  return true;
}

std::string text(const RecordFields& fields, std::string_view name) {
  const auto field = fields.find(name);
  return field == fields.end() ? "" : field->second;
}

template <class Number>
bool number(const RecordFields& fields, std::string_view name, Number* value) {
  const std::string bytes = text(fields, name);
  if (bytes.size() != sizeof(Number)) return false;
  *value = little_endian<Number>({reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size()});
  return true;
}

struct Record {
  uint8_t op = 0;
  RecordFields fields;
  int64_t data_at = 0, data_bytes = 0;
};

// Reads the header of the record at `at`; nullopt if there is none. The record's data may be cut off: its length is not
// checked against the file.
std::optional<Record> read_record(ByteSource& source, int64_t at) {
  std::array<uint8_t, kLengthBytes> length;
  if (!source.read(at, length)) return std::nullopt;
  const auto header_bytes = little_endian<uint32_t>(length);
  if (header_bytes > kMostHeaderBytes) return std::nullopt;
  std::vector<uint8_t> header(header_bytes);
  Record record;
  const int64_t behind = at + static_cast<int64_t>(kLengthBytes) + header_bytes;
  if (!source.read(at + static_cast<int64_t>(kLengthBytes), header) || !source.read(behind, length) ||
      !parse_fields(header, &record.fields) || !number(record.fields, "op", &record.op))
    return std::nullopt;
  record.data_at = behind + static_cast<int64_t>(kLengthBytes);
  record.data_bytes = little_endian<uint32_t>(length);
  return record;
}

class Ros1Bag : public RecordBag {
 public:
  using RecordBag::RecordBag;
  std::string refusal() const override { return refusal_; }

 protected:
  int64_t begin(ByteSource& file) override {
    std::array<uint8_t, kMagic.size()> magic{};
    file.read(0, magic);
    const std::string_view found(reinterpret_cast<const char*>(magic.data()), magic.size());
    if (found == kMagic) return static_cast<int64_t>(kMagic.size());
    if (found.starts_with(kAnyMagic))
      refusal_ =
          "is a ROS 1 bag of an old format, which is not read: `rosbag filter OLD.bag NEW.bag True` of ROS writes it "
          "anew";
    return kNoRecord;
  }

  int64_t take(ByteSource& source, int64_t at, int32_t chunk) override {
    std::optional<Record> record = read_record(source, at);
    if (!record) return kNoRecord;
    if (record->op == kChunk && chunk == BagPlace::kInFile) return take_chunk_record(*record);
    const int64_t next = record->data_at + record->data_bytes;
    if (next > source.size()) return kNoRecord;
    if (record->op == kMessage) return take_message_record(source, *record, chunk) ? next : kNoRecord;
    if (record->op == kConnection) return take_connection(source, *record) ? next : kNoRecord;
    if (record->op == kBagHeader && !text(record->fields, "encryptor").empty())
      refusal_ = "is an encrypted bag, which is not read: decrypt it by ROS (`rosbag decompress` or `rosbag filter`)";
    const bool is_known = record->op == kBagHeader || record->op == kIndex || record->op == kChunkInfo;
    return is_known ? next : kNoRecord;
  }

  // Finds records by the field "op=", with which messages, connections and chunks begin.
  int64_t find_record(ByteSource& file, int64_t from) override {
    constexpr std::string_view kOpField("\4\0\0\0op=", 7);
    constexpr int64_t kPieceBytes = 1 << 20, kFarthestBack = 256;
    std::vector<uint8_t> piece;
    for (int64_t at = from; at < file.size(); at += kPieceBytes) {
      piece.resize(static_cast<size_t>(std::min(file.size() - at, kPieceBytes + kFarthestBack)));
      if (!file.read(at, piece)) break;
      const std::string_view bytes(reinterpret_cast<const char*>(piece.data()), piece.size());
      for (size_t op = bytes.find(kOpField); op != std::string_view::npos; op = bytes.find(kOpField, op + 1))
        for (int64_t begin = std::max(from, at + static_cast<int64_t>(op) - kFarthestBack);
             begin < at + static_cast<int64_t>(op); ++begin)
          if (seems_record(file, begin)) return begin;
    }
    return file.size();
  }

 private:
  static bool seems_record(ByteSource& file, int64_t at) {
    const std::optional<Record> record = read_record(file, at);
    if (!record) return false;
    uint32_t connection = 0;
    if (record->op == kChunk) return !text(record->fields, "compression").empty();
    return (record->op == kMessage || record->op == kConnection) && number(record->fields, "conn", &connection) &&
           record->data_at + record->data_bytes <= file.size();
  }

  int64_t take_chunk_record(const Record& record) {
    const std::string name = text(record.fields, "compression");
    const std::optional<Compression> compression = compression_named(name);
    if (!compression || name.empty() || *compression == Compression::kZstd) return kNoRecord;
    if (*compression == Compression::kNone) return record.data_at;
    return take_chunk(record.data_at, record.data_bytes, *compression);
  }

  bool take_message_record(ByteSource& source, const Record& record, int32_t chunk) {
    BagMessage message;
    uint64_t time = 0;
    if (!number(record.fields, "conn", &message.connection) || !number(record.fields, "time", &time)) return false;
    constexpr int64_t kNanoseconds = 1'000'000'000;
    message.time_ns = static_cast<int64_t>(time & 0xffffffff) * kNanoseconds + static_cast<int64_t>(time >> 32);
    message.place = {0, chunk, record.data_at, record.data_bytes};
    take_message(source, &message);
    return true;
  }

  bool take_connection(ByteSource& source, const Record& record) {
    uint32_t id = 0;
    if (!number(record.fields, "conn", &id) || record.data_bytes > kMostDefinitionBytes) return false;
    std::vector<uint8_t> data(static_cast<size_t>(record.data_bytes));
    RecordFields fields;
    if (!source.read(record.data_at, data) || !parse_fields(data, &fields)) return false;
    // Takes the topic from the record's header, under which the bag stores the messages; the one in the data is the
    // publisher's, from before a remapping.
    add_connection(id, {text(record.fields, "topic"), type_named(text(fields, "type")), RosEncoding::kRos1});
    return true;
  }

  std::string refusal_;
};

}  // namespace

std::unique_ptr<BagFile> open_ros1_bag(const std::string& file) { return std::make_unique<Ros1Bag>(file); }

}  // namespace rumi
