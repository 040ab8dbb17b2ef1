// SPDX-License-Identifier: BSD-3-Clause
#include "base/files/whole_file.h"

#include <gmock/gmock.h>

#include "tests/support/temporary_folder.h"

namespace rumi {
namespace {

TEST(WholeFile, IsThereOnceItIsCommitted) {
  const testing::TemporaryFolder folder;
  {
    WholeFile file(folder / "a");
    file.write("never");
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "a"));
  WholeFile file(folder / "a");
  file.write("whole");
  EXPECT_EQ(file.commit().error_text(), "");
  EXPECT_EQ(testing::read_file(folder / "a"), "whole");
}

TEST(WholeFile, WhatIsOverwrittenKeepsItsPlace) {
  const testing::TemporaryFolder folder;
  WholeFile file(folder / "a");
  file.write("head??tail");
  file.overwrite(4, "__");
  file.write(", end");
  EXPECT_EQ(file.commit().error_text(), "");
  EXPECT_EQ(testing::read_file(folder / "a"), "head__tail, end");
}

TEST(WholeFile, TellsOfItsProblemAtOnce) {
  const testing::TemporaryFolder folder;
  WholeFile file(folder / "no/such/folder");
  file.write("x");
  file.overwrite(0, "y");
  EXPECT_THAT(file.so_far().error_text(), ::testing::HasSubstr("No such file or directory"));
  EXPECT_EQ(file.commit().error_text(), file.so_far().error_text());
}

}  // namespace
}  // namespace rumi
