// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/outputs/reserved_space.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "map_server/outputs/output_files.h"
#include "rumi/outputs/map_file.h"
#include "rumi/outputs/run_record.h"
#include "tests/rumi/small_atlas.h"
#include "tests/support/temporary_folder.h"

namespace rumi::tool {
namespace {

namespace fs = std::filesystem;
using rumi::testing::TemporaryFolder;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr int kNoNamespaces = -1;

TEST(ReservedSpace, ARunIsRefusedWhereNotEvenItsTablesFit) {
  const TemporaryFolder folder;
  const std::string disk = folder.path().string();
  const int result = rumi::testing::run_on_small_disk(disk, 600'000, [&] {
    ReservedSpace space;
    const std::string problem = space.take(disk, 90).error_text();
    return problem.find(disk + ": its disk has 0.6 MB free") != 0 ||
           problem.find("choose another folder") == std::string::npos;
  });
  if (result == kNoNamespaces) GTEST_SKIP() << "no mount namespaces here";
  EXPECT_EQ(result, 0);
}

TEST(ReservedSpace, IsThereAtTheEndWhateverFilledTheDiskMeanwhile) {
  const TemporaryFolder folder;
  const std::string disk = folder.path().string();
  const int result = rumi::testing::run_on_small_disk(disk, 3'000'000, [&] {
    ReservedSpace space;
    if (!space.take(disk, 90)) return 1;
    rumi::testing::write_file(disk + "/log", std::string(4'000'000, 'x'));
    if (fs::space(disk).available > 0) return 2;
    space.release();
    if (!map_server::write_outputs(make_test_atlas(), disk).empty()) return 3;
    return fs::exists(disk + "/trajectory.txt") && fs::file_size(disk + "/frames.csv") > 0 ? 0 : 4;
  });
  if (result == kNoNamespaces) GTEST_SKIP() << "no mount namespaces here";
  EXPECT_EQ(result, 0);
}

TEST(ReservedSpace, LeavesNoFile) {
  const TemporaryFolder folder;
  ReservedSpace space;
  EXPECT_EQ(space.take(folder.path().string(), -1).error_text(), "");
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(RunOutputs, WhatFitsIsWrittenAndWhatDoesNotIsNamed) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "map.ply" + "/in the way");
  const std::vector<std::string> missing = write_run_outputs(make_test_atlas(), folder.path().string());
  ASSERT_EQ(missing.size(), 1);
  EXPECT_THAT(missing[0], HasSubstr("map.ply"));
  EXPECT_TRUE(fs::exists(folder / "trajectory.txt"));
  nlohmann::ordered_json run;
  EXPECT_THAT(note_missing(missing, "out", &run),
              AllOf(HasSubstr("map.ply"), HasSubstr("what could be written is in out")));
  EXPECT_EQ(run["missing"].size(), 1);
}

}  // namespace
}  // namespace rumi::tool
