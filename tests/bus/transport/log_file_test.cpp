// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "bus/transport/log_bus.h"
#include "lcmtypes/rumi/map_request_t.hpp"
#include "tests/support/temporary_folder.h"

namespace rumi {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

class LogTest : public ::testing::Test {
 protected:
  std::string file(const std::string& name = "x.log") const { return folder_ / name; }
  // Writes ten events on two channels, 1 s apart.
  void write_ten() {
    LogWriter writer(file());
    for (int i = 0; i < 10; ++i)
      ASSERT_TRUE(writer.write(1'000'000 * (i + 1), i % 2 ? "ODD" : "EVEN", std::vector<uint8_t>(100 * i, i)));
    ASSERT_TRUE(writer.close());
  }
  std::vector<uint8_t> bytes() const {
    std::ifstream stream(file(), std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  void put(const std::vector<uint8_t>& content) const {
    std::ofstream(file(), std::ios::binary).write(reinterpret_cast<const char*>(content.data()), content.size());
  }
  const testing::TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
};

TEST_F(LogTest, WhatIsWrittenIsRead) {
  write_ten();
  EXPECT_TRUE(is_lcm_log(file()));
  LogReader reader(file());
  for (int i = 0; i < 10; ++i) {
    const auto event = reader.next();
    ASSERT_TRUE(event);
    EXPECT_EQ(event->utime_us, 1'000'000 * (i + 1));
    EXPECT_EQ(event->channel, i % 2 ? "ODD" : "EVEN");
    EXPECT_EQ(event->data, std::vector<uint8_t>(100 * i, i));
  }
  EXPECT_FALSE(reader.next());
  EXPECT_EQ(reader.error(), "");
}

TEST_F(LogTest, OneChannelOnly) {
  write_ten();
  LogReader reader(file());
  int count = 0;
  while (const auto event = reader.next_on("ODD")) EXPECT_EQ(event->data.size(), 100u * (2 * count++ + 1));
  EXPECT_EQ(count, 5);
  EXPECT_EQ(reader.error(), "");
}

TEST_F(LogTest, LcmReadsOurLogs) {
  write_ten();
  lcm::LogFile log(file(), "r");
  int count = 0;
  while (const lcm::LogEvent* event = log.readNextEvent()) EXPECT_EQ(event->eventnum, count++);
  EXPECT_EQ(count, 10);
}

TEST_F(LogTest, ATruncatedLogGivesItsWholeEventsAndSaysSo) {
  write_ten();
  const std::vector<uint8_t> whole = bytes();
  for (const size_t size : {whole.size() - 1, whole.size() - 905, whole.size() - 930, whole.size() - 934}) {
    put({whole.begin(), whole.begin() + static_cast<ptrdiff_t>(size)});
    LogReader reader(file());
    int count = 0;
    while (reader.next()) ++count;
    const bool clean = size == whole.size() - 931;
    EXPECT_EQ(count, size == whole.size() - 934 ? 8 : 9) << size;
    EXPECT_EQ(reader.error().empty(), clean) << size;
    EXPECT_THAT(reader.error(), HasSubstr("ends in the middle of an event"));
    EXPECT_THAT(reader.error(), HasSubstr("x.log: damaged at byte"));
  }
}

TEST_F(LogTest, WhatIsNoLogIsSaidToBeNone) {
  put({'h', 'e', 'l', 'l', 'o', ' ', 'w', 'o', 'r', 'l', 'd', '.', '.', '.', '.',
       '.', '.', '.', '.', '.', '.', '.', '.', '.', '.', '.', '.', '.', '.', '.'});
  EXPECT_FALSE(is_lcm_log(file()));
  LogReader reader(file());
  EXPECT_FALSE(reader.next());
  EXPECT_THAT(reader.error(), HasSubstr("this is not an lcm log"));
}

TEST_F(LogTest, MissingFilesFoldersAndEmptyFiles) {
  EXPECT_THAT(LogReader(file("none")).error(), HasSubstr("none: cannot be opened (No such file"));
  EXPECT_THAT(LogReader(folder_).error(), HasSubstr("is not a file"));
  EXPECT_FALSE(is_lcm_log(folder_));
  put({});
  LogReader reader(file());
  EXPECT_FALSE(reader.next());
  EXPECT_EQ(reader.error(), "");
}

TEST_F(LogTest, RandomDamageNeverCrashesAndKeepsWhatIsBefore) {
  write_ten();
  const std::vector<uint8_t> whole = bytes();
  std::mt19937 random(3);
  for (int i = 0; i < 500; ++i) {
    std::vector<uint8_t> damaged = whole;
    const size_t first = random() % damaged.size();
    for (int n = 0; n < 3; ++n) damaged[first + random() % (damaged.size() - first)] = static_cast<uint8_t>(random());
    put(damaged);
    LogReader reader(file());
    int count = 0;
    int64_t end = 0;
    while (const auto event = reader.next()) {
      end += 28 + static_cast<int64_t>(event->channel.size() + event->data.size());
      if (end <= static_cast<int64_t>(first)) {
        EXPECT_EQ(event->utime_us, 1'000'000 * (count + 1));
      }
      ++count;
    }
    if (count < 10) {
      EXPECT_GE(end + 28 + 4 + 900, static_cast<int64_t>(first));
    }
  }
}

TEST_F(LogTest, HugeLengthsAreDamageAndAllocateNothing) {
  write_ten();
  std::vector<uint8_t> damaged = bytes();
  for (int i = 24; i < 28; ++i) damaged[i] = 0x7f;
  put(damaged);
  LogReader reader(file());
  EXPECT_FALSE(reader.next());
  EXPECT_THAT(reader.error(), HasSubstr("damaged at byte 0"));
}

TEST_F(LogTest, AFolderThatCannotBeWrittenIsNamed) {
  LogWriter writer("/nowhere/x.log");
  EXPECT_THAT(writer.error(), HasSubstr("/nowhere/x.log: cannot be created"));
  EXPECT_FALSE(writer.write(1, "A", {}));
  EXPECT_FALSE(writer.close());
}

TEST_F(LogTest, AFullDiskIsReported) {
  if (access("/dev/full", W_OK) != 0) GTEST_SKIP() << "SKIPPED: no /dev/full here";
  LogWriter writer("/dev/full");
  bool ok = true;
  for (int i = 0; i < 100 && ok; ++i) ok = writer.write(i, "A", std::vector<uint8_t>(1000));
  EXPECT_FALSE(ok) << "more was written than is held back";
  EXPECT_FALSE(writer.close());
  EXPECT_THAT(writer.error(), HasSubstr("No space left"));
}

TEST_F(LogTest, TheBusDeliversEventByEventAtItsTime) {
  {
    LogBus out(nullptr, std::make_unique<LogWriter>(file()));
    for (int i = 1; i <= 3; ++i) {
      out.set_now_us(i * 1000);
      map_request_t m{};
      m.request_id = i;
      EXPECT_TRUE(out.publish("A", m));
      EXPECT_TRUE(out.publish_raw("A", std::vector<uint8_t>{1, 2, 3}));
      EXPECT_TRUE(out.publish("UNHEARD", m));
    }
    EXPECT_EQ(out.published(), 9);
    EXPECT_EQ(out.dispatch(), 0);
  }
  LogBus in(std::make_unique<LogReader>(file()), nullptr);
  std::vector<std::pair<int64_t, int>> seen;
  in.subscribe<map_request_t>("A", {}, [&](const map_request_t& m) { seen.emplace_back(in.now_us(), m.request_id); });
  EXPECT_EQ(in.dispatch(), 1);
  EXPECT_EQ(seen.size(), 1u);
  while (in.dispatch()) {
  }
  EXPECT_TRUE(in.ended());
  EXPECT_EQ(in.read_error(), "");
  EXPECT_EQ(seen, (std::vector<std::pair<int64_t, int>>{{1000, 1}, {2000, 2}, {3000, 3}}));
  EXPECT_EQ(in.counts().at(0).received, 6);
  EXPECT_EQ(in.counts().at(0).undecodable, 3);
  EXPECT_FALSE(in.publish_raw("A", {}));
}

}  // namespace
}  // namespace rumi
