// SPDX-License-Identifier: BSD-3-Clause
// Tests the index of a ROS 1 bag, which our own reader does not use. tests/rumi/rosbag_test.sh reads a bag by it with
// ROS's own program.
#include <gtest/gtest.h>

#include <map>

#include "formats/bag_writer/bag_writer.h"
#include "formats/image/byte_source.h"
#include "tests/support/temporary_folder.h"

namespace rumi {
namespace {

class Ros1Index : public ::testing::Test {
 protected:
  struct Record {
    std::map<std::string, std::string> fields;
    size_t data_at = 0, end = 0;
  };
  Ros1Index() {
    const std::string file = folder_ / "a.bag";
    const std::unique_ptr<BagWriter> writer = write_ros1_bag(file);
    for (int i = 0; i < kMessages; ++i)
      writer->write(i % 2 == 0 ? "/a" : "/b", kImageType, int64_t{1'000'000'000} * (i + 1), std::string(100'000, 'x'));
    EXPECT_EQ(writer->close().error_text(), "");
    text_ = testing::read_file(file);
  }
  template <class Number>
  static Number number(const std::string& text, size_t at = 0) {
    return little_endian<Number>({reinterpret_cast<const uint8_t*>(text.data()) + at, sizeof(Number)});
  }
  Record record(size_t at) const {
    Record record;
    const size_t header_end = at + 4 + number<uint32_t>(text_, at);
    for (size_t field = at + 4; field < header_end; field += 4 + number<uint32_t>(text_, field)) {
      const std::string text = text_.substr(field + 4, number<uint32_t>(text_, field));
      record.fields[text.substr(0, text.find('='))] = text.substr(text.find('=') + 1);
    }
    record.data_at = header_end + 4;
    record.end = record.data_at + number<uint32_t>(text_, header_end);
    return record;
  }
  static constexpr int kMessages = 100;
  testing::TemporaryFolder folder_;
  std::string text_;
};

TEST_F(Ros1Index, IsWhereTheHeaderSays) {
  constexpr size_t kMagicBytes = 13, kHeaderBytes = 4096;
  const Record header = record(kMagicBytes);
  EXPECT_EQ(header.end, kMagicBytes + kHeaderBytes);
  EXPECT_EQ(header.fields.at("op"), "\3");
  EXPECT_EQ(number<uint32_t>(header.fields.at("conn_count")), 2u);
  int connections = 0, chunks = 0, messages = 0;
  for (size_t at = number<uint64_t>(header.fields.at("index_pos")); at < text_.size();) {
    const Record entry = record(at);
    at = entry.end;
    if (entry.fields.at("op") == "\7") {
      ++connections;
      continue;
    }
    ASSERT_EQ(entry.fields.at("op"), "\6");
    ++chunks;
    const Record chunk = record(number<uint64_t>(entry.fields.at("chunk_pos")));
    EXPECT_EQ(chunk.fields.at("op"), "\5");
    Record index = record(chunk.end);
    for (int i = 0; i < 2; ++i, index = record(index.end)) {
      ASSERT_EQ(index.fields.at("op"), "\4");
      const uint32_t count = number<uint32_t>(index.fields.at("count"));
      EXPECT_EQ(number<uint32_t>(text_, entry.data_at + 8 * i + 4), count);
      for (uint32_t k = 0; k < count; ++k, ++messages) {
        const Record message = record(chunk.data_at + number<uint32_t>(text_, index.data_at + 12 * k + 8));
        EXPECT_EQ(message.fields.at("op"), "\2");
        EXPECT_EQ(message.fields.at("conn"), index.fields.at("conn"));
        EXPECT_EQ(message.fields.at("time"), text_.substr(index.data_at + 12 * k, 8));
        EXPECT_LE(number<uint32_t>(entry.fields.at("start_time")), number<uint32_t>(message.fields.at("time")));
        EXPECT_GE(number<uint32_t>(entry.fields.at("end_time")), number<uint32_t>(message.fields.at("time")));
      }
    }
  }
  EXPECT_EQ(connections, 2);
  EXPECT_GT(chunks, 1);
  EXPECT_EQ(number<uint32_t>(header.fields.at("chunk_count")), static_cast<uint32_t>(chunks));
  EXPECT_EQ(messages, kMessages);
}

}  // namespace
}  // namespace rumi
