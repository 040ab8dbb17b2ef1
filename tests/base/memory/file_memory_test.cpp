// SPDX-License-Identifier: BSD-3-Clause
#include "base/memory/file_memory.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory_resource>
#include <string>
#include <thread>
#include <vector>

#include "base/files/temporary_folder.h"

namespace rumi {
namespace {

namespace fs = std::filesystem;
using Numbers = std::pmr::vector<uint32_t>;

constexpr size_t kMiB = 1 << 20;

Numbers numbers(FileMemory* memory, uint32_t first, size_t count) {
  Numbers made(count, memory);
  for (size_t i = 0; i < count; ++i) made[i] = first + static_cast<uint32_t>(i);
  return made;
}

// Returns the RAM that the process uses for mapped files, in bytes.
size_t file_ram() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (word == "RssFile:") {
      size_t kib = 0;
      status >> kib;
      return kib << 10;
    }
  return 0;
}

TEST(FileMemory, KeepsWhatIsWrittenThroughLettingGo) {
  const TemporaryFolder folder(fs::temp_directory_path(), "rumi-test-");
  FileMemory memory(folder.path());
  std::vector<Numbers> kept;
  for (uint32_t i = 0; i < 50; ++i) kept.push_back(numbers(&memory, i, 1000 + 317 * i));
  memory.let_go();
  for (uint32_t i = 0; i < 50; ++i) EXPECT_EQ(kept[i], numbers(&memory, i, 1000 + 317 * i)) << i;
  EXPECT_TRUE(fs::is_empty(folder.path())) << "the file has a name";
}

TEST(FileMemory, LettingGoReleasesRam) {
  const TemporaryFolder folder(fs::temp_directory_path(), "rumi-test-");
  FileMemory memory(folder.path());
  const size_t before = file_ram();
  const Numbers kept = numbers(&memory, 0, 64 * kMiB / sizeof(uint32_t));
  const size_t used = file_ram();
  if (used < before + 60 * kMiB) GTEST_SKIP() << "the folder lies in RAM";
  memory.let_go();
  EXPECT_LT(file_ram(), before + 4 * kMiB);
  EXPECT_EQ(kept.back(), 64 * kMiB / sizeof(uint32_t) - 1);
}

TEST(FileMemory, FreedPagesAreUsedAgain) {
  const TemporaryFolder folder(fs::temp_directory_path(), "rumi-test-");
  FileMemory memory(folder.path());
  for (int round = 0; round < 1000; ++round) const Numbers gone = numbers(&memory, 0, 20'000 + round);
  EXPECT_LE(memory.file_bytes(), 8 * kMiB);
}

TEST(FileMemory, MoreThanItGrowsByAtOnce) {
  const TemporaryFolder folder(fs::temp_directory_path(), "rumi-test-");
  FileMemory memory(folder.path());
  const Numbers large = numbers(&memory, 7, 5'000'000), small = numbers(&memory, 9, 10);
  EXPECT_EQ(large.back(), 5'000'006U);
  EXPECT_EQ(small.front(), 9U);
}

TEST(FileMemory, UsesOrdinaryMemoryWhereThereIsNoFile) {
  FileMemory memory("/no/such/folder");
  const Numbers kept = numbers(&memory, 3, 10'000);
  memory.let_go();
  EXPECT_EQ(kept.back(), 10'002U);
  EXPECT_EQ(memory.file_bytes(), 0U);
}

TEST(FileMemory, SeveralThreadsUseIt) {
  const TemporaryFolder folder(fs::temp_directory_path(), "rumi-test-");
  FileMemory memory(folder.path());
  std::vector<int> wrong(4, 0);
  std::vector<std::thread> threads;
  for (uint32_t t = 0; t < 4; ++t)
    threads.emplace_back([&, t] {
      for (uint32_t i = 0; i < 200; ++i) {
        const Numbers made = numbers(&memory, 1000 * t + i, 3000);
        if (i % 16 == 0) memory.let_go();
        for (uint32_t k = 0; k < 3000; ++k) wrong[t] += made[k] != 1000 * t + i + k;
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, std::vector<int>(4, 0));
}

}  // namespace
}  // namespace rumi
