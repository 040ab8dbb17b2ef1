// SPDX-License-Identifier: BSD-3-Clause
#include "base/this_process/standard_output.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <functional>

namespace rumi {
namespace {

// Returns the exit code of a child process whose stdout is the file, or closed if `file` is null.
int in_child(const char* file, const std::function<int()>& work) {
  std::fflush(stdout);
  const pid_t child = fork();
  if (child == 0) {
    close(STDOUT_FILENO);
    if (file && open(file, O_WRONLY) != STDOUT_FILENO) _exit(99);
    _exit(work());
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

bool has(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

TEST(StandardOutput, AFullDiskIsAnErrorHoweverLittleWasPrinted) {
  if (access("/dev/full", W_OK) != 0) GTEST_SKIP() << "SKIPPED: no /dev/full here";
  EXPECT_EQ(in_child("/dev/full",
                     [] {
                       std::fputs("a word\n", stdout);
                       return has(flush_stdout(), "cannot write: No space left on device") ? 0 : 1;
                     }),
            0);
  EXPECT_EQ(in_child("/dev/full",
                     [] {
                       std::fputs("a word\n", stdout);
                       flush_stdout();
                       return has(flush_stdout(), "No space left on device") ? 0 : 1;
                     }),
            0)
      << "asked a second time";
  EXPECT_EQ(in_child("/dev/null",
                     [] {
                       std::fputs("a word\n", stdout);
                       return flush_stdout().empty() ? 0 : 1;
                     }),
            0);
}

TEST(StandardOutput, NoFileTakesThePlaceOfAClosedOne) {
  EXPECT_EQ(in_child(nullptr,
                     [] {
                       hold_standard_streams();
                       if (open("/dev/null", O_WRONLY) == STDOUT_FILENO) return 1;
                       std::fputs("a word\n", stdout);
                       return has(flush_stdout(), "cannot write") ? 0 : 2;
                     }),
            0);
}

}  // namespace
}  // namespace rumi
