// SPDX-License-Identifier: BSD-3-Clause
// Writes small bags of ROS of each kind, as plain as they may be.
#pragma once

#include <bzlib.h>
#include <fmt/format.h>
#include <lz4frame.h>
#include <zlib.h>
#include <zstd.h>
#include <fstream>

#include <bit>
#include <cstdint>
#include <functional>
#include <map>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "base/files/sqlite.h"

namespace rumi::testing {

template <class Number>
std::string bytes_of(Number value) {
  std::string bytes;
  for (size_t i = 0; i < sizeof(Number); ++i) bytes += static_cast<char>(static_cast<uint64_t>(value) >> 8 * i);
  return bytes;
}
inline std::string with_length(const std::string& text) { return bytes_of(static_cast<uint32_t>(text.size())) + text; }

// Serializes for ROS 1, or for ROS 2 (CDR, little endian).
class RosWriter {
 public:
  explicit RosWriter(bool is_ros2) : is_ros2_(is_ros2) {
    if (is_ros2_) bytes_ = std::string("\0\1\0\0", 4);
  }
  RosWriter& header(int64_t stamp_ns, const std::string& frame = "camera") {
    if (!is_ros2_) number<uint32_t>(7);  // seq
    number(static_cast<uint32_t>(stamp_ns / 1'000'000'000)).number(static_cast<uint32_t>(stamp_ns % 1'000'000'000));
    return text(frame);
  }
  template <class Number>
  RosWriter& number(Number value) {
    while (is_ros2_ && bytes_.size() % std::min(sizeof(Number), size_t{8}) != 4 % sizeof(Number)) bytes_ += '\0';
    bytes_ += bytes_of(value);
    return *this;
  }
  RosWriter& real(double value) { return number(std::bit_cast<uint64_t>(value)); }
  RosWriter& data(const std::string& data) {
    number(static_cast<uint32_t>(data.size()));
    bytes_ += data;
    return *this;
  }
  RosWriter& text(const std::string& text) { return data(is_ros2_ ? text + '\0' : text); }
  const std::string& bytes() const { return bytes_; }

 private:
  bool is_ros2_;
  std::string bytes_;
};

struct BagMessageToWrite {
  std::string topic, type, bytes;  // type: such as "sensor_msgs/Image"
  int64_t time_ns = 0;
};

inline std::string image_message(bool is_ros2, int64_t stamp_ns, const cv::Mat& pixels, const std::string& encoding,
                                 bool is_big_endian = false, const std::string& frame = "camera") {
  RosWriter out(is_ros2);
  const cv::Mat whole = pixels.clone();
  out.header(stamp_ns, frame).number(static_cast<uint32_t>(whole.rows)).number(static_cast<uint32_t>(whole.cols));
  out.text(encoding).number(static_cast<uint8_t>(is_big_endian)).number(static_cast<uint32_t>(whole.step[0]));
  return out.data(std::string(whole.datastart, whole.dataend)).bytes();
}

inline std::string compressed_message(bool is_ros2, int64_t stamp_ns, const std::string& format,
                                      const std::vector<uint8_t>& file) {
  return RosWriter(is_ros2).header(stamp_ns).text(format).data(std::string(file.begin(), file.end())).bytes();
}

struct TransformToWrite {
  int64_t stamp_ns = 0;
  std::string parent, child;
  std::vector<double> translation = {0, 0, 0}, rotation = {0, 0, 0, 1};  // x y z, x y z w
};
inline std::string transforms_message(bool is_ros2, const std::vector<TransformToWrite>& transforms) {
  RosWriter out(is_ros2);
  out.number(static_cast<uint32_t>(transforms.size()));
  for (const TransformToWrite& transform : transforms) {
    out.header(transform.stamp_ns, transform.parent).text(transform.child);
    for (const double value : transform.translation) out.real(value);
    for (const double value : transform.rotation) out.real(value);
  }
  return out.bytes();
}

// A camera_info for images of 64 x 48 pixels.
struct InfoToWrite {
  std::string model = "plumb_bob";
  std::vector<double> d = {0.1, 0, 0, 0, 0};
  double fx = 50, px = 60;  // focal lengths in K and in P, pixels
};
inline std::string info_message(bool is_ros2, int64_t stamp_ns, const InfoToWrite& info = {}) {
  RosWriter out(is_ros2);
  out.header(stamp_ns).number(uint32_t{48}).number(uint32_t{64}).text(info.model);
  out.number(static_cast<uint32_t>(info.d.size()));
  for (const double d : info.d) out.real(d);
  const double last = info.fx == 0 ? 0 : 1;
  for (const double k : {info.fx, 0., 32. * last, 0., 51. * last, 24. * last, 0., 0., last}) out.real(k);
  for (const double r : {1, 0, 0, 0, 1, 0, 0, 0, 1}) out.real(r);
  for (const double p : {info.px, 0., 30., 0., 0., 61., 20., 0., 0., 0., 1., 0.}) out.real(p);
  for (int i = 0; i < 6; ++i) out.number(uint32_t{0});
  return out.number(uint8_t{0}).bytes();
}

inline std::string compressed(const std::string& name, const std::string& bytes) {
  std::string out(bytes.size() + 100'000, '\0');
  if (name == "bz2") {
    auto size = static_cast<unsigned>(out.size());
    BZ2_bzBuffToBuffCompress(out.data(), &size, const_cast<char*>(bytes.data()), static_cast<unsigned>(bytes.size()), 9,
                             0, 0);
    out.resize(size);
  } else if (name == "lz4") {
    out.resize(LZ4F_compressFrame(out.data(), out.size(), bytes.data(), bytes.size(), nullptr));
  } else if (name == "zstd") {
    out.resize(ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), 1));
  } else {
    return bytes;
  }
  return out;
}

// Number of messages in each chunk.
inline constexpr size_t kMessagesInChunk = 6;

class Ros1Writer {
 public:
  explicit Ros1Writer(std::string compression) : compression_(std::move(compression)) {
    bytes_ = "#ROSBAG V2.0\n" + record(3, {{"index_pos", bytes_of(uint64_t{0})}}, std::string(500, ' '));
  }
  void add(const BagMessageToWrite& message) {
    const auto [connection, is_new] = connections_.try_emplace(message.topic, connections_.size());
    const std::string conn = bytes_of(static_cast<uint32_t>(connection->second));
    if (is_new) {
      const std::string known = record(7, {{"conn", conn}, {"topic", message.topic}},
                                       with_length("topic=" + message.topic) + with_length("type=" + message.type));
      chunk_ += known;
      connection_records_ += known;
    }
    const std::string time = bytes_of(static_cast<uint32_t>(message.time_ns / 1'000'000'000)) +
                             bytes_of(static_cast<uint32_t>(message.time_ns % 1'000'000'000));
    chunk_ += record(2, {{"conn", conn}, {"time", time}}, message.bytes);
    if (++in_chunk_ == kMessagesInChunk) end_chunk();
  }
  std::string bytes() {
    end_chunk();
    return bytes_ + connection_records_;
  }
  static std::string record(uint8_t op, const std::map<std::string, std::string>& fields, const std::string& data) {
    std::string header = with_length("op=" + bytes_of(op));
    for (const auto& [name, value] : fields) header += with_length(name + "=" + value);
    return with_length(header) + with_length(data);
  }

 private:
  void end_chunk() {
    if (chunk_.empty()) return;
    bytes_ += record(5, {{"compression", compression_}, {"size", bytes_of(static_cast<uint32_t>(chunk_.size()))}},
                     compressed(compression_, chunk_));
    bytes_ += record(4, {{"ver", bytes_of(uint32_t{1})}, {"conn", bytes_of(uint32_t{0})}}, std::string(12, '\1'));
    chunk_.clear();
    in_chunk_ = 0;
  }
  std::string compression_, bytes_, chunk_, connection_records_;
  std::map<std::string, size_t> connections_;
  size_t in_chunk_ = 0;
};

class McapWriter {
 public:
  // `compression`: how chunks are compressed; "none": they are not; empty: the file has no chunks. `encoding`: that of
  // the messages.
  explicit McapWriter(std::string compression, std::string encoding = "cdr", size_t in_one_chunk = kMessagesInChunk)
      : compression_(std::move(compression)), encoding_(std::move(encoding)), in_one_chunk_(in_one_chunk) {
    bytes_ = kMagic + record(1, with_length("ros2") + with_length("test"));
  }
  void add(const BagMessageToWrite& message) {
    const auto [channel, is_new] = channels_.try_emplace(message.topic, channels_.size() + 1);
    const std::string id = bytes_of(static_cast<uint16_t>(channel->second));
    if (is_new) {
      const size_t slash = message.type.find('/');
      const std::string type = slash == std::string::npos
                                   ? message.type
                                   : message.type.substr(0, slash) + "/msg" + message.type.substr(slash);
      const std::string known =
          record(3, id + with_length(type) + with_length("ros2msg") + with_length("")) +
          record(4, id + id + with_length(message.topic) + with_length(encoding_) + with_length(""));
      chunk_ += known;
      definitions_ += known;
    }
    chunk_ +=
        record(5, id + bytes_of(uint32_t{1}) + bytes_of(message.time_ns) + bytes_of(message.time_ns) + message.bytes);
    if (++in_chunk_ == in_one_chunk_) end_chunk();
  }
  std::string bytes() {
    end_chunk();
    return bytes_ + record(15, bytes_of(uint32_t{0})) + definitions_ + record(2, std::string(20, '\0')) + kMagic;
  }

 private:
  static inline const std::string kMagic = std::string("\x89MCAP0\r\n", 8);
  static std::string record(uint8_t op, const std::string& content) {
    return bytes_of(op) + bytes_of(static_cast<uint64_t>(content.size())) + content;
  }
  void end_chunk() {
    if (chunk_.empty()) return;
    if (compression_.empty()) {
      bytes_ += chunk_;
    } else {
      const std::string stored = compressed(compression_, chunk_);
      const auto crc = static_cast<uint32_t>(
          crc32_z(0, reinterpret_cast<const Bytef*>(chunk_.data()), static_cast<z_size_t>(chunk_.size())));
      bytes_ += record(6, std::string(16, '\0') + bytes_of(static_cast<uint64_t>(chunk_.size())) + bytes_of(crc) +
                              with_length(compression_ == "none" ? "" : compression_) +
                              bytes_of(static_cast<uint64_t>(stored.size())) + stored);
      bytes_ += record(7, std::string(6, '\0'));
    }
    chunk_.clear();
    in_chunk_ = 0;
  }
  std::string compression_, encoding_, bytes_, chunk_, definitions_;
  size_t in_one_chunk_;
  std::map<std::string, size_t> channels_;
  size_t in_chunk_ = 0;
};

inline void write_sqlite_bag(const std::string& file, const std::vector<BagMessageToWrite>& messages) {
  Database database(file);
  database.execute(
      "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT, offered TEXT);"
      "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB);"
      "BEGIN");
  std::map<std::string, int> topics;
  for (const BagMessageToWrite& message : messages) {
    const auto [topic, is_new] = topics.try_emplace(message.topic, static_cast<int>(topics.size()) + 1);
    const size_t slash = message.type.find('/');
    if (is_new)
      Statement(database, "INSERT INTO topics VALUES (?, ?, ?, 'cdr', '')")
          .bind(topic->second, message.topic, message.type.substr(0, slash) + "/msg" + message.type.substr(slash))
          .run();
    const std::span<const uint8_t> data(reinterpret_cast<const uint8_t*>(message.bytes.data()), message.bytes.size());
    Statement(database, "INSERT INTO messages(topic_id, timestamp, data) VALUES (?, ?, ?)")
        .bind(topic->second, message.time_ns, data)
        .run();
  }
  database.execute("COMMIT");
}

// The kinds of bags, as write_bag() takes them.
inline const std::vector<std::string>& bag_kinds() {
  static const std::vector<std::string> kKinds = {"ros1 none", "ros1 bz2", "ros1 lz4",  "mcap",
                                                  "mcap none", "mcap lz4", "mcap zstd", "sqlite"};
  return kKinds;
}
inline bool is_ros2(const std::string& kind) { return !kind.starts_with("ros1"); }

// Writes a bag of this kind. Returns the file's name.
inline std::string write_bag(const std::string& folder, const std::string& kind,
                             const std::vector<BagMessageToWrite>& messages) {
  const std::string rest = kind.size() > 5 ? kind.substr(5) : "";
  const std::string file = folder + "/bag" + (kind == "sqlite" ? ".db3" : is_ros2(kind) ? ".mcap" : ".bag");
  std::filesystem::remove(file);
  if (kind == "sqlite") {
    write_sqlite_bag(file, messages);
    return file;
  }
  Ros1Writer ros1(rest);
  McapWriter mcap(rest);
  for (const BagMessageToWrite& message : messages) is_ros2(kind) ? mcap.add(message) : ros1.add(message);
  std::ofstream(file, std::ios::binary) << (is_ros2(kind) ? mcap.bytes() : ros1.bytes());
  return file;
}

}  // namespace rumi::testing
