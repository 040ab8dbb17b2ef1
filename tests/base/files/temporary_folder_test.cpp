// SPDX-License-Identifier: BSD-3-Clause
#include "base/files/temporary_folder.h"

#include <gmock/gmock.h>

#include <fstream>
#include <optional>
#include <stdexcept>

#include "tests/support/temporary_folder.h"

namespace rumi {
namespace {

namespace fs = std::filesystem;

TEST(TemporaryFolder, GoesWithAllThatIsInIt) {
  const testing::TemporaryFolder parent;
  std::optional<TemporaryFolder> folder;
  folder.emplace(parent.path(), "mine-");
  const fs::path path = folder->path();
  EXPECT_EQ(path.parent_path(), fs::path(parent.path()));
  EXPECT_THAT(path.filename().string(), ::testing::StartsWith("mine-"));
  fs::create_directory(path / "inner");
  std::ofstream(path / "inner" / "file") << "x";
  folder.reset();
  EXPECT_FALSE(fs::exists(path));
}

TEST(TemporaryFolder, SaysWhereItCannotBeMade) {
  const testing::TemporaryFolder parent;
  EXPECT_THAT([&] { TemporaryFolder(fs::path(parent / "nowhere"), "mine-"); },
              ::testing::ThrowsMessage<std::runtime_error>(
                  ::testing::ContainsRegex("nowhere/mine-.*: cannot be made: No such")));
}

}  // namespace
}  // namespace rumi
