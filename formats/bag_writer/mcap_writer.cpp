// SPDX-License-Identifier: BSD-3-Clause
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <limits>
#include <map>
#include <vector>

#include "base/files/whole_file.h"
#include "base/this_process/process_name.h"
#include "formats/bag_writer/bag_writer.h"
#include "formats/bag_writer/put_bytes.h"

namespace rumi {
namespace {

constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);
enum Op : uint8_t {
  kHeader = 1,
  kFooter = 2,
  kSchema = 3,
  kChannel = 4,
  kMessage = 5,
  kChunk = 6,
  kMessageIndex = 7,
  kChunkIndex = 8,
  kStatistics = 11,
  kSummaryOffset = 14,
  kDataEnd = 15
};

uint32_t crc_of(std::string_view bytes, uint32_t before = 0) {
  return static_cast<uint32_t>(crc32_z(before, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

std::string record(Op op, std::string_view content) {
  std::string bytes;
  put(static_cast<uint8_t>(op), &bytes);
  put(static_cast<uint64_t>(content.size()), &bytes);
  return bytes.append(content);
}

std::string compressed(const std::string& bytes) {
  constexpr int kLevel = 1;  // low: images are most of the data, and higher levels take long and gain little
  std::string out(ZSTD_compressBound(bytes.size()), '\0');
  out.resize(ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), kLevel));
  return out;
}

struct TimeSpan {
  uint64_t first_ns = std::numeric_limits<uint64_t>::max(), last_ns = 0;
  void add(uint64_t time_ns) {
    first_ns = std::min(first_ns, time_ns);
    last_ns = std::max(last_ns, time_ns);
  }
  void put_to(std::string* out) const {
    put(first_ns > last_ns ? 0 : first_ns, out);
    put(last_ns, out);
  }
};

class McapWriter : public BagWriter {
 public:
  explicit McapWriter(const std::string& file) : BagWriter(Ros::k2), file_(file) {
    add(kMagic);
    std::string content;
    put_text("ros2", &content);
    put_text(std::string("rumi ") + version(), &content);
    add(record(kHeader, content));
  }

  void write(const std::string& topic, const std::string& type, int64_t time_ns, const std::string& message) override {
    if (chunk_.size() + message.size() > kChunkBytes) end_chunk();
    const uint16_t channel = channel_of(topic, type);
    const auto utime_ns = static_cast<uint64_t>(time_ns);
    index_[channel].emplace_back(utime_ns, chunk_.size());
    std::string content;
    put(channel, &content);
    put(messages_[channel]++, &content);  // sequence
    put(utime_ns, &content);
    put(utime_ns, &content);
    chunk_ += record(kMessage, content.append(message));
    chunk_span_.add(utime_ns);
    span_.add(utime_ns);
  }

  const Result<>& so_far() const override { return file_.so_far(); }

  Result<> close() override {
    end_chunk();
    std::string content;
    put(crc_, &content);
    add(record(kDataEnd, content));
    write_summary();
    file_.write(kMagic);
    return file_.commit();
  }

 private:
  void add(std::string_view bytes) {
    file_.write(bytes);
    crc_ = crc_of(bytes, crc_);
    position_ += bytes.size();
  }

  uint16_t channel_of(const std::string& topic, const std::string& type) {
    const auto known = channels_.find(topic);
    if (known != channels_.end()) return known->second;
    const auto [schema, is_new] = schemas_.try_emplace(type, static_cast<uint16_t>(schemas_.size() + 1));
    if (is_new) chunk_ += define_schema(schema->second, type);
    const auto channel = static_cast<uint16_t>(channels_.size() + 1);
    channels_[topic] = channel;
    chunk_ += define_channel(channel, schema->second, topic);
    return channel;
  }
  std::string define_schema(uint16_t id, const std::string& type) {
    std::string content;
    put(id, &content);
    put_text(full_name(type, Ros::k2), &content);
    put_text("ros2msg", &content);
    put_text(definition_of(type, Ros::k2), &content);
    return schema_records_.emplace_back(record(kSchema, content));
  }
  std::string define_channel(uint16_t id, uint16_t schema, const std::string& topic) {
    std::string content;
    put(id, &content);
    put(schema, &content);
    put_text(topic, &content);
    put_text("cdr", &content);
    put(uint32_t{0}, &content);  // size of further properties, which there are not
    return channel_records_.emplace_back(record(kChannel, content));
  }

  void end_chunk() {
    if (chunk_.empty()) return;
    const std::string stored = compressed(chunk_);
    std::string content;
    chunk_span_.put_to(&content);
    put(static_cast<uint64_t>(chunk_.size()), &content);
    put(crc_of(chunk_), &content);
    put_text("zstd", &content);
    put(static_cast<uint64_t>(stored.size()), &content);
    const uint64_t begin = position_;
    add(record(kChunk, content.append(stored)));
    write_index(begin, position_ - begin, stored.size());
    chunk_.clear();
    index_.clear();
    chunk_span_ = {};
  }

  // Writes the chunk's index behind the chunk, and keeps the record on the chunk for the summary.
  void write_index(uint64_t chunk_at, uint64_t chunk_record_bytes, uint64_t stored_bytes) {
    const uint64_t begin = position_;
    std::string offsets;
    for (const auto& [channel, messages] : index_) {
      put(channel, &offsets);
      put(position_, &offsets);
      std::string entries;
      for (const auto& [time_ns, offset] : messages) {
        put(time_ns, &entries);
        put(offset, &entries);
      }
      std::string content;
      put(channel, &content);
      put_text(entries, &content);
      add(record(kMessageIndex, content));
    }
    std::string content;
    chunk_span_.put_to(&content);
    put(chunk_at, &content);
    put(chunk_record_bytes, &content);
    put_text(offsets, &content);
    put(position_ - begin, &content);
    put_text("zstd", &content);
    put(stored_bytes, &content);
    put(static_cast<uint64_t>(chunk_.size()), &content);
    chunk_records_.push_back(record(kChunkIndex, content));
  }

  std::string statistics() const {
    uint64_t all = 0;
    std::string counts, content;
    for (const auto& [channel, count] : messages_) {
      put(channel, &counts);
      put(static_cast<uint64_t>(count), &counts);
      all += count;
    }
    put(all, &content);
    put(static_cast<uint16_t>(schemas_.size()), &content);
    put(static_cast<uint32_t>(channels_.size()), &content);
    put(uint32_t{0}, &content);  // attachments
    put(uint32_t{0}, &content);  // metadata
    put(static_cast<uint32_t>(chunk_records_.size()), &content);
    span_.put_to(&content);
    put_text(counts, &content);
    return record(kStatistics, content);
  }

  // Writes the summary, so that nobody has to read the whole file; then the offsets of the kinds of records in the
  // summary.
  void write_summary() {
    const uint64_t begin = position_;
    std::string summary, offsets;
    const auto add_group = [&](Op op, const std::vector<std::string>& records) {
      if (records.empty()) return;
      const uint64_t group_at = begin + summary.size();
      for (const std::string& one : records) summary += one;
      std::string content;
      put(static_cast<uint8_t>(op), &content);
      put(group_at, &content);
      put(begin + summary.size() - group_at, &content);
      offsets += record(kSummaryOffset, content);
    };
    add_group(kSchema, schema_records_);
    add_group(kChannel, channel_records_);
    add_group(kStatistics, {statistics()});
    add_group(kChunkIndex, chunk_records_);
    std::string footer;
    put(begin, &footer);
    put(begin + summary.size(), &footer);
    put(uint32_t{0}, &footer);  // the place of the checksum, which covers all of the summary before it
    footer = record(kFooter, footer);
    footer.resize(footer.size() - sizeof(uint32_t));
    const std::string checked = summary + offsets + footer;
    std::string crc;
    put(crc_of(checked), &crc);
    add(checked + crc);
  }

  WholeFile file_;
  uint64_t position_ = 0;
  uint32_t crc_ = 0;  // checksum of everything so far
  std::map<std::string, uint16_t> schemas_, channels_;
  std::vector<std::string> schema_records_, channel_records_, chunk_records_;
  std::map<uint16_t, uint32_t> messages_;
  TimeSpan span_, chunk_span_;
  std::string chunk_;
  std::map<uint16_t, std::vector<std::pair<uint64_t, uint64_t>>> index_;  // of the chunk: times and positions
};

}  // namespace

std::unique_ptr<BagWriter> write_mcap_file(const std::string& file) { return std::make_unique<McapWriter>(file); }

}  // namespace rumi
