// SPDX-License-Identifier: BSD-3-Clause
#include "rumi/run/program_folder.h"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace rumi::tool {
namespace {

namespace fs = std::filesystem;
using rumi::testing::TemporaryFolder;

TEST(ProgramFolder, IsBesideTheCommandInABuildTree) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "build/bin");
  EXPECT_EQ(program_folder_of(folder / "build/bin"), fs::path(folder / "build/bin"));
}

TEST(ProgramFolder, IsOffThePathWhereInstalledWhateverIsBesideTheCommand) {
  const TemporaryFolder folder;
  const fs::path bin = folder / "prefix/bin", installed = (bin / RUMI_PROGRAMS_FROM_BIN).lexically_normal();
  fs::create_directories(bin / "map_server");
  fs::create_directories(installed);
  EXPECT_EQ(program_folder_of(bin), installed);
}

}  // namespace
}  // namespace rumi::tool
