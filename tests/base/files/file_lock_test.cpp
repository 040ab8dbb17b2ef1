// SPDX-License-Identifier: BSD-3-Clause
#include "base/files/file_lock.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>

#include "tests/support/temporary_folder.h"

namespace rumi {
namespace {

TEST(FileLock, IsHeldOnceAndGivenBack) {
  const testing::TemporaryFolder folder;
  const std::string file = folder / "lock";
  {
    const auto held = FileLock::take(file);
    ASSERT_TRUE(held);
    errno = 0;
    EXPECT_FALSE(FileLock::take(file));
    EXPECT_EQ(errno, EWOULDBLOCK);
    EXPECT_EQ(holder_of_lock(file), "unknown");
    held->sign();
    EXPECT_EQ(holder_of_lock(file), std::to_string(getpid()));
  }
  EXPECT_EQ(holder_of_lock(file), std::nullopt);
  EXPECT_TRUE(FileLock::take(file));
}

TEST(FileLock, SaysWhyItCannotBeMade) {
  const testing::TemporaryFolder folder;
  EXPECT_FALSE(FileLock::take(folder / "absent/lock"));
  EXPECT_EQ(errno, ENOENT);
  EXPECT_EQ(holder_of_lock(folder / "absent/lock"), std::nullopt);
}

// A lock on a removed file does not keep others from locking a new file of that name.
TEST(FileLock, OfARemovedFileIsNobodys) {
  const testing::TemporaryFolder folder;
  const std::string file = folder / "lock";
  const auto held = FileLock::take(file);
  std::filesystem::remove(file);
  EXPECT_TRUE(FileLock::take(file));
}

TEST(FileLock, IsGivenBackByAProcessThatIsKilled) {
  const testing::TemporaryFolder folder;
  const std::string file = folder / "lock";
  const pid_t child = fork();
  if (child == 0) {
    const auto held = FileLock::take(file);
    raise(SIGKILL);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_TRUE(FileLock::take(file));
}

}  // namespace
}  // namespace rumi
