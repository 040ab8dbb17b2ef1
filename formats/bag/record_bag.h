// SPDX-License-Identifier: BSD-3-Clause
// Reads bags that consist of records (ROS 1's and MCAP) from the beginning to the end. It needs no index: a bag whose
// recording broke off has none. Records in an uncompressed chunk are read as if there were no chunk.
#pragma once

#include <string>

#include "formats/bag/bag_file.h"
#include "formats/bag/decompress.h"

namespace rumi {

class RecordBag : public BagFile {
 public:
  explicit RecordBag(std::string file) : name_(std::move(file)), bytes_(name_) {}

  void scan(const Visit& visit) override;
  const std::map<uint32_t, BagConnection>& connections() const override { return connections_; }
  const std::map<uint32_t, int64_t>& other_messages() const override { return other_messages_; }
  const BagDamage& damage() const override { return damage_; }
  int64_t size_bytes() const override { return bytes_.size(); }
  bool read(const BagPlace& place, std::vector<uint8_t>* bytes) override;

 protected:
  static constexpr int64_t kNoRecord = -1;
  static constexpr int64_t kNoEnd = -2;  // there is a record, but where the next one begins is not known
  // Returns the position of the first record; kNoRecord if the file does not begin as it should.
  virtual int64_t begin(ByteSource& file) = 0;
  // Reads the record at `at`, and returns where the next one begins. Returns kNoRecord if there is no record or it is
  // cut off, and kNoEnd if it was read as far as possible, but its end is not known.
  virtual int64_t take(ByteSource& source, int64_t at, int32_t chunk) = 0;
  // Returns the first place from `from` on where a record seems to begin; the file's end if there is none.
  virtual int64_t find_record(ByteSource& file, int64_t from) = 0;

  // Reads a chunk, for take(). Returns where the next record begins, or kNoEnd. `crc`: the checksum of the decompressed
  // bytes, if the bag has one.
  static constexpr uint32_t kNoCrc = 0;
  int64_t take_chunk(int64_t at, int64_t stored_bytes, Compression compression, uint32_t crc = kNoCrc);
  void take_message(ByteSource& source, BagMessage* message);
  void add_connection(uint32_t id, BagConnection connection) {
    connections_.insert_or_assign(id, std::move(connection));
  }
  bool knows(uint32_t connection) const { return connections_.contains(connection); }

 private:
  struct Chunk {
    int64_t at, stored_bytes;
    Compression compression;
  };
  // Counts damage from `from` to `to`. `lost`: how many bytes of good records are missing there.
  void count_damage(int64_t from, int64_t to, int64_t lost, const std::string& what);

  std::string name_;
  FileBytes bytes_;
  Visit visit_;
  bool is_enough_ = false;  // visit_ has returned false
  std::map<uint32_t, BagConnection> connections_;
  std::map<uint32_t, int64_t> other_messages_;
  BagDamage damage_;
  std::vector<Chunk> chunks_;
  int32_t open_chunk_ = -1;
  std::vector<uint8_t> open_bytes_;
};

}  // namespace rumi
