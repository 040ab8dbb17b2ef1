// SPDX-License-Identifier: BSD-3-Clause
// Tests bags with any kind of damage: images that can be read are played, and the user is told of those that are lost.
#include <algorithm>

#include "tests/formats/bag/bag_fixture.h"

namespace rumi::camera_driver {
namespace {

using namespace testing;
using ::testing::HasSubstr;

constexpr int kImages = 24;

class DamagedBags : public Bags {
 protected:
  DamagedBags() { give_calibration(); }
  // Writes the bytes into the file and plays it. Returns the number of images; -1 if the bag is refused, with a
  // message.
  int images_of(const std::string& file, const std::string& bytes) {
    testing::write_file(file, bytes);
    const OpenedSource opened = open(file);
    if (!opened.has_value()) {
      EXPECT_THAT(opened.error_text(), HasSubstr(file));
      return -1;
    }
    int images = 0;
    while ((*opened)->next()) ++images;
    skipped_ = (*opened)->skipped();
    return images;
  }
};

TEST_F(DamagedBags, InAnyPlaceLoseWhatIsThere) {
  // A chunk has three images, and its neighbour may have begun in the damaged bytes.
  constexpr int kMostLost = 8;
  for (const std::string& kind : bag_kinds()) {
    add_usual(kind, kImages);
    const std::string file = write(kind), whole = testing::read_file(file);
    if (kind == "sqlite") continue;  // tested below
    const size_t length = 40, step = std::max<size_t>(1, whole.size() / 60);
    for (size_t at = 0; at + length < whole.size(); at += step) {
      SCOPED_TRACE(kind + " at " + std::to_string(at));
      std::string bytes = whole;
      for (size_t i = at; i < at + length; ++i) bytes[i] = static_cast<char>(bytes[i] ^ 0x5A);
      EXPECT_GE(images_of(file, bytes), kImages - kMostLost);
      // Pixels that are stored uncompressed have no checksum.
      const bool has_checksum = kind.find("bz2") != std::string::npos || kind == "mcap zstd" || kind == "mcap lz4";
      const bool is_in_data = at > 1000 && at + 2000 < whole.size();
      if (has_checksum && is_in_data) {
        EXPECT_GT(skipped_.total(), 0);
      }
    }
  }
}

// The whole file is one chunk. Noise cannot be compressed and is stored as it is: then only its checksum is wrong.
TEST_F(DamagedBags, InTheMiddleOfAChunkHaveTheImagesBefore) {
  for (const bool is_noise : {false, true}) {
    for (const char* compression : {"zstd", "lz4"}) {
      SCOPED_TRACE(std::string(compression) + (is_noise ? " noise" : ""));
      constexpr size_t kAll = 1000;
      McapWriter mcap(compression, "cdr", kAll);
      cv::theRNG().state = 7;
      for (int i = 0; i < kImages; ++i) {
        cv::Mat pixels = picture(i, 320, 240);
        if (is_noise) cv::randu(pixels, 0, 256);
        mcap.add({"/cam0/image_raw", "sensor_msgs/Image", image_message(true, stamp_ns(i), pixels, "mono8"), 1});
      }
      options_.camera_file = folder_.write("c.yaml", "fx: 50\nfy: 51\ncx: 32\ncy: 24\nwidth: 320\nheight: 240\n");
      std::string bytes = mcap.bytes();
      const size_t at = bytes.size() * 9 / 20;  // inside an image, not between two
      for (size_t i = at; i < at + 64; ++i) bytes[i] = static_cast<char>(7 * i + 3);
      EXPECT_GE(images_of(folder_ / "a.mcap", bytes), is_noise ? kImages : kImages / 3);
      EXPECT_GE(skipped_.malformed, 1);
    }
  }
}

TEST_F(DamagedBags, CutOffAnywhereHaveTheImagesBefore) {
  for (const std::string& kind : bag_kinds()) {
    if (kind == "sqlite") continue;
    add_usual(kind, kImages);
    const std::string file = write(kind), whole = testing::read_file(file);
    int before = -1;
    for (int part = 1; part <= 40; ++part) {
      const int images = images_of(file, whole.substr(0, whole.size() * part / 41));
      EXPECT_GE(images, before) << kind << " " << part;
      before = images;
    }
    EXPECT_GE(before, kImages - 4) << kind;
    EXPECT_EQ(skipped_.malformed, 0) << kind;  // what is missing at the end need not be images
  }
}

TEST_F(DamagedBags, LengthsThatAreTooLargeTakeNoMemory) {
  for (const std::string& kind : {std::string("ros1 none"), std::string("mcap"), std::string("mcap none")}) {
    add_usual(kind, 6);
    const std::string file = write(kind), whole = testing::read_file(file);
    for (size_t at = 13; at + 4 < std::min<size_t>(whole.size(), 1500); at += 3) {
      std::string bytes = whole;
      bytes.replace(at, 4, "\xff\xff\xff\x7f");
      images_of(file, bytes);
    }
  }
}

TEST_F(DamagedBags, ABagThatIsStillBeingRecordedIsReadToItsLastMessage) {
  add_usual("ros1 none", 0);
  Ros1Writer whole("none");
  for (const BagMessageToWrite& message : messages_) whole.add(message);
  // The recorder writes the length of a chunk only when the chunk ends.
  const std::string begun =
      Ros1Writer::record(5, {{"compression", "none"}, {"size", bytes_of(uint32_t{0})}}, "") +
      Ros1Writer::record(7, {{"conn", bytes_of(uint32_t{5})}, {"topic", "/a"}}, with_length("type=sensor_msgs/Image")) +
      Ros1Writer::record(2, {{"conn", bytes_of(uint32_t{5})}, {"time", bytes_of(uint64_t{1})}},
                         image_message(false, stamp_ns(0), picture(0), "mono8")) +
      Ros1Writer::record(2, {{"conn", bytes_of(uint32_t{5})}, {"time", bytes_of(uint64_t{1})}},
                         image_message(false, stamp_ns(1), picture(1), "mono8"));
  EXPECT_EQ(images_of(folder_ / "a.bag.active", whole.bytes() + begun.substr(0, begun.size() - 100)), 1);
}

TEST_F(DamagedBags, PagesOfADatabaseThatAreBrokenArePassedOver) {
  add_usual("sqlite", kImages);
  const std::string file = write("sqlite"), whole = testing::read_file(file);
  constexpr size_t kPage = 4096;
  int read_in_all = 0;
  for (size_t page = 0; page < whole.size() / kPage; ++page) {
    std::string bytes = whole;
    std::fill_n(bytes.begin() + static_cast<ptrdiff_t>(page * kPage), kPage, '\x5A');
    const int images = images_of(file, bytes);
    if (images >= kImages - 8) ++read_in_all;
    if (images >= 0 && images < kImages) {
      EXPECT_GT(skipped_.total(), 0) << "page " << page;
    }
  }
  EXPECT_GE(read_in_all, static_cast<int>(whole.size() / kPage) - 6);
}

TEST_F(DamagedBags, MessagesThatAreNoneAreLeftOut) {
  for (const std::string& kind : bag_kinds()) {
    add_usual(kind, 6);
    messages_[5].bytes.resize(40);
    messages_[7].bytes.clear();
    const std::string file = write(kind);
    EXPECT_EQ(images_of(file, testing::read_file(file)), 4) << kind;
    EXPECT_EQ(skipped_.total(), 2) << kind;
  }
}

TEST_F(DamagedBags, EndlesslyCompressedChunksAreNotUnpacked) {
  const std::string bomb = compressed("zstd", std::string(257 << 20, '\0'));
  const auto record = [](uint8_t op, const std::string& content) {
    return bytes_of(op) + bytes_of(static_cast<uint64_t>(content.size())) + content;
  };
  const std::string chunk =
      record(6, std::string(28, '\0') + with_length("zstd") + bytes_of(static_cast<uint64_t>(bomb.size())) + bomb);
  EXPECT_THAT(error_of(folder_.write("a.mcap", std::string("\x89MCAP0\r\n", 8) + chunk)),
              HasSubstr("nothing in it can be read"));
}

}  // namespace
}  // namespace rumi::camera_driver
