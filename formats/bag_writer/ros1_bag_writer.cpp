// SPDX-License-Identifier: BSD-3-Clause
// Writes ROS 1's bags, format 2.0. A record is a header of fields "name=value", and data, each preceded by its length.
#include <algorithm>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "base/files/whole_file.h"
#include "formats/bag_writer/bag_writer.h"
#include "formats/bag_writer/put_bytes.h"

namespace rumi {
namespace {

constexpr std::string_view kMagic = "#ROSBAG V2.0\n";
enum Op : uint8_t { kMessage = 2, kBagHeader = 3, kIndex = 4, kChunk = 5, kChunkInfo = 6, kConnection = 7 };

template <class Number>
std::string bytes_of(Number value) {
  std::string bytes;
  put(value, &bytes);
  return bytes;
}

// Returns a time as seconds and nanoseconds, of 4 bytes each.
std::string time_of(int64_t time_ns) {
  constexpr int64_t kNanoseconds = 1'000'000'000;
  return bytes_of(static_cast<uint32_t>(time_ns / kNanoseconds)) +
         bytes_of(static_cast<uint32_t>(time_ns % kNanoseconds));
}

using Fields = std::vector<std::pair<std::string_view, std::string>>;

std::string header_of(const Fields& fields) {
  std::string bytes;
  for (const auto& [name, value] : fields) put_text(std::string(name) + "=" + value, &bytes);
  return bytes;
}

std::string record(Op op, Fields fields, std::string_view data) {
  fields.emplace_back("op", bytes_of(static_cast<uint8_t>(op)));
  std::string bytes;
  put_text(header_of(fields), &bytes);
  put_text(data, &bytes);
  return bytes;
}

// Returns the bag's header. It always has the same length, because it is overwritten at the end, when its values are
// known.
std::string bag_header(uint64_t index_at, size_t connections, size_t chunks) {
  constexpr size_t kBytes = 4096;
  const auto with_padding = [&](size_t bytes) {
    return record(kBagHeader,
                  {{"index_pos", bytes_of(index_at)},
                   {"conn_count", bytes_of(static_cast<uint32_t>(connections))},
                   {"chunk_count", bytes_of(static_cast<uint32_t>(chunks))}},
                  std::string(bytes, ' '));
  };
  return with_padding(kBytes - with_padding(0).size());
}

class Ros1BagWriter : public BagWriter {
 public:
  explicit Ros1BagWriter(const std::string& file) : BagWriter(Ros::k1), file_(file) {
    add(std::string(kMagic) + bag_header(0, 0, 0));
  }

  void write(const std::string& topic, const std::string& type, int64_t time_ns, const std::string& message) override {
    if (chunk_.size() + message.size() > kChunkBytes) end_chunk();
    const uint32_t connection = connection_of(topic, type);
    put_entry(time_ns, static_cast<uint32_t>(chunk_.size()), &index_[connection]);
    chunk_ += record(kMessage, {{"conn", bytes_of(connection)}, {"time", time_of(time_ns)}}, message);
    first_ns_ = std::min(first_ns_, time_ns);
    last_ns_ = std::max(last_ns_, time_ns);
  }

  const Result<>& so_far() const override { return file_.so_far(); }

  Result<> close() override {
    end_chunk();
    const uint64_t index_at = position_;
    add(connection_records_ + chunk_infos_);
    file_.overwrite(static_cast<int64_t>(kMagic.size()), bag_header(index_at, connections_.size(), chunks_));
    return file_.commit();
  }

 private:
  struct Index {  // index of a connection's messages in a chunk
    uint32_t count = 0;
    std::string entries;
  };
  static void put_entry(int64_t time_ns, uint32_t offset, Index* index) {
    ++index->count;
    index->entries += time_of(time_ns) + bytes_of(offset);
  }

  void add(std::string_view bytes) {
    file_.write(bytes);
    position_ += bytes.size();
  }

  uint32_t connection_of(const std::string& topic, const std::string& type) {
    const auto [connection, is_new] = connections_.try_emplace(topic, static_cast<uint32_t>(connections_.size()));
    if (is_new) {
      const Fields fields = {{"topic", topic},
                             {"type", type},
                             {"md5sum", md5_of(type)},
                             {"message_definition", definition_of(type, Ros::k1)}};
      const std::string known =
          record(kConnection, {{"conn", bytes_of(connection->second)}, {"topic", topic}}, header_of(fields));
      chunk_ += known;
      connection_records_ += known;
    }
    return connection->second;
  }

  void end_chunk() {
    if (index_.empty()) return;
    std::string counts;
    for (const auto& [connection, index] : index_) counts += bytes_of(connection) + bytes_of(index.count);
    chunk_infos_ += record(kChunkInfo,
                           {{"ver", bytes_of(uint32_t{1})},
                            {"chunk_pos", bytes_of(position_)},
                            {"start_time", time_of(first_ns_)},
                            {"end_time", time_of(last_ns_)},
                            {"count", bytes_of(static_cast<uint32_t>(index_.size()))}},
                           counts);
    add(record(kChunk, {{"compression", "none"}, {"size", bytes_of(static_cast<uint32_t>(chunk_.size()))}}, chunk_));
    for (const auto& [connection, index] : index_)
      add(record(kIndex,
                 {{"ver", bytes_of(uint32_t{1})}, {"conn", bytes_of(connection)}, {"count", bytes_of(index.count)}},
                 index.entries));
    ++chunks_;
    chunk_.clear();
    index_.clear();
    first_ns_ = kNoTime;
    last_ns_ = 0;
  }

  WholeFile file_;
  uint64_t position_ = 0;
  size_t chunks_ = 0;
  std::map<std::string, uint32_t> connections_;
  std::string connection_records_, chunk_infos_, chunk_;
  std::map<uint32_t, Index> index_;
  static constexpr int64_t kNoTime = std::numeric_limits<int64_t>::max();
  int64_t first_ns_ = kNoTime, last_ns_ = 0;  // first and last time in the chunk
};

}  // namespace

std::unique_ptr<BagWriter> write_ros1_bag(const std::string& file) { return std::make_unique<Ros1BagWriter>(file); }

}  // namespace rumi
