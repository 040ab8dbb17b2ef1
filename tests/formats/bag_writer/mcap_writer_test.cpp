// SPDX-License-Identifier: BSD-3-Clause
// Tests the index of an MCAP file, which our own reader does not use: its entries point to what they name, and the
// checksums are right.
#include <gtest/gtest.h>
#include <zlib.h>
#include <zstd.h>

#include <map>

#include "formats/bag_writer/bag_writer.h"
#include "formats/image/byte_source.h"
#include "tests/support/temporary_folder.h"

namespace rumi {
namespace {

constexpr size_t kMagicBytes = 8, kHeadBytes = 9;

class McapIndex : public ::testing::Test {
 protected:
  struct Record {
    uint8_t op = 0;
    size_t at = 0, bytes = 0;  // position and size of its content, behind the head
    size_t end() const { return at + bytes; }
  };
  McapIndex() {
    const std::string file = folder_ / "a.mcap";
    const std::unique_ptr<BagWriter> writer = write_mcap_file(file);
    for (int i = 0; i < kMessages; ++i)
      writer->write(i % 2 == 0 ? "/a" : "/b", kImageType, 1000 + i,
                    std::string(100'000, static_cast<char>('a' + i % 7)));
    EXPECT_EQ(writer->close().error_text(), "");
    text_ = testing::read_file(file);
  }
  template <class Number>
  static Number number(const std::string& text, size_t at) {
    return little_endian<Number>({reinterpret_cast<const uint8_t*>(text.data()) + at, sizeof(Number)});
  }
  template <class Number>
  Number number(size_t at) const {
    return number<Number>(text_, at);
  }
  Record record(size_t at) const { return {number<uint8_t>(at), at + kHeadBytes, number<uint64_t>(at + 1)}; }
  uint32_t crc(size_t from, size_t to) const { return crc_of(text_.substr(from, to - from)); }
  static uint32_t crc_of(const std::string& text) {
    return static_cast<uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(text.data()), text.size()));
  }
  Record footer() const { return record(text_.size() - kMagicBytes - kHeadBytes - 20); }

  static constexpr int kMessages = 100;
  testing::TemporaryFolder folder_;
  std::string text_;
};

TEST_F(McapIndex, ChecksumsAreThoseOfTheBytes) {
  ASSERT_EQ(footer().op, 2);
  const size_t summary = number<uint64_t>(footer().at);
  EXPECT_EQ(number<uint32_t>(footer().at + 16), crc(summary, footer().at + 16));
  const size_t data_end = summary - kHeadBytes - 4;
  ASSERT_EQ(record(data_end).op, 15);
  EXPECT_EQ(number<uint32_t>(data_end + kHeadBytes), crc(0, data_end));
}

TEST_F(McapIndex, NamesEveryMessage) {
  std::map<int, int> ops;
  int indexed = 0;
  for (size_t at = number<uint64_t>(footer().at); at < footer().at - kHeadBytes; at = record(at).end()) {
    const Record entry = record(at);
    ++ops[entry.op];
    if (entry.op != 8) continue;
    const Record chunk = record(number<uint64_t>(entry.at + 16));
    ASSERT_EQ(chunk.op, 6);
    EXPECT_EQ(number<uint64_t>(entry.at + 24), kHeadBytes + chunk.bytes);
    // The compressed records lie behind the times, size and checksum (28 bytes), the string "zstd" with its length (8)
    // and their own length (8).
    const size_t stored_at = chunk.at + 28 + 8 + 8, stored = number<uint64_t>(stored_at - 8);
    std::string messages(number<uint64_t>(chunk.at + 16), '\0');
    ASSERT_EQ(ZSTD_decompress(messages.data(), messages.size(), text_.data() + stored_at, stored), messages.size());
    EXPECT_EQ(number<uint32_t>(chunk.at + 24), crc_of(messages));
    const uint32_t offsets = number<uint32_t>(entry.at + 32);
    for (size_t offset = entry.at + 36; offset < entry.at + 36 + offsets; offset += 10) {
      const Record index = record(number<uint64_t>(offset + 2));
      ASSERT_EQ(index.op, 7);
      EXPECT_EQ(number<uint16_t>(index.at), number<uint16_t>(offset));
      for (size_t message = index.at + 6; message < index.end(); message += 16, ++indexed) {
        const size_t place = number<uint64_t>(message + 8);
        EXPECT_EQ(messages[place], 5);
        EXPECT_EQ(number<uint16_t>(messages, place + kHeadBytes), number<uint16_t>(offset));
        EXPECT_EQ(number<uint64_t>(messages, place + kHeadBytes + 6), number<uint64_t>(message));
      }
    }
  }
  EXPECT_EQ(indexed, kMessages);
  EXPECT_EQ(ops[3], 1);   // schemas
  EXPECT_EQ(ops[4], 2);   // channels
  EXPECT_GT(ops[8], 1);   // chunks
  EXPECT_EQ(ops[11], 1);  // statistics
  EXPECT_EQ(ops[14], 4);  // offsets in the summary
}

}  // namespace
}  // namespace rumi
