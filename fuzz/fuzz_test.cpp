// SPDX-License-Identifier: BSD-3-Clause
// Runs every target without libFuzzer: on its seeds, on seeds that are cut short or have bytes changed, and on inputs
// that broke it once (fuzz/found/TARGET/). The tests only assert that every run ends; the sanitizers of the sanitized
// build find the other faults.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <random>

#include "fuzz/target.h"
#include "tests/support/temporary_folder.h"

namespace rumi::fuzz {
namespace {

namespace fs = std::filesystem;

constexpr int kVariantsOfSeed = 12;

class FuzzTarget : public ::testing::TestWithParam<Target> {};

TEST_P(FuzzTarget, TakesItsSeeds) {
  const std::vector<Bytes> seeds = GetParam().seeds();
  ASSERT_FALSE(seeds.empty());
  GetParam().run({});
  for (const Bytes& seed : seeds) GetParam().run(seed);
}

TEST_P(FuzzTarget, TakesDamagedSeeds) {
  std::mt19937 random(5);
  for (const Bytes& seed : GetParam().seeds()) {
    for (int i = 0; i < kVariantsOfSeed && !seed.empty(); ++i) {
      Bytes bytes = seed;
      if (i % 3 == 0) bytes.resize(random() % bytes.size());
      for (int change = 0; change < i && !bytes.empty(); ++change)
        bytes[random() % bytes.size()] = static_cast<uint8_t>(random());
      GetParam().run(bytes);
    }
  }
}

TEST_P(FuzzTarget, TakesWhatOnceBrokeIt) {
  const fs::path folder = fs::path(RUMI_FUZZ_FOUND) / GetParam().name;
  if (!fs::exists(folder)) return;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    SCOPED_TRACE(file.string());
    GetParam().run(to_bytes(testing::read_file(file.string())));
  }
}

INSTANTIATE_TEST_SUITE_P(All, FuzzTarget, ::testing::ValuesIn(targets()),
                         [](const auto& target) { return target.param.name; });

}  // namespace
}  // namespace rumi::fuzz
