// SPDX-License-Identifier: BSD-3-Clause
#include "base/this_process/account_limits.h"

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <functional>
#include <new>

#include "base/files/sqlite.h"
#include "base/files/whole_file.h"
#include "base/running/failures.h"
#include "tests/support/temporary_folder.h"

namespace rumi {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

// Returns what `work` returns in a child process under this limit.
std::string under_limit(__rlimit_resource_t resource, rlim_t most, const std::function<std::string()>& work) {
  int ends[2];
  EXPECT_EQ(pipe(ends), 0);
  const pid_t child = fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    rlimit limit{};
    getrlimit(resource, &limit);
    limit.rlim_cur = most;
    setrlimit(resource, &limit);
    const std::string said = work();
    _exit(write(ends[1], said.data(), said.size()) == static_cast<ssize_t>(said.size()) ? 0 : 1);
  }
  close(ends[1]);
  std::string said(4096, ' ');
  said.resize(std::max<ssize_t>(0, read(ends[0], said.data(), said.size())));
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  return said;
}

TEST(AccountLimits, TheSizeOfAFileIsNamed) {
  EXPECT_THAT(under_limit(RLIMIT_FSIZE, 200'000, [] { return write_error_text(EFBIG); }),
              HasSubstr("no file may have more than 0.2 MB here (ulimit -f)"));
  EXPECT_THAT(under_limit(RLIMIT_FSIZE, 200'000, [] { return write_error_text(ENOSPC); }), Not(HasSubstr("ulimit")));
}

TEST(AccountLimits, AFileAndADatabaseThatHitItSaySo) {
  const testing::TemporaryFolder folder;
  EXPECT_THAT(under_limit(RLIMIT_FSIZE, 100'000,
                          [&] {
                            WholeFile file(folder / "large");
                            file.write(std::string(300'000, 'x'));
                            return file.commit().error_text();
                          }),
              AllOf(HasSubstr("cannot write "), HasSubstr("large"), HasSubstr("ulimit -f")));
  EXPECT_THAT(under_limit(RLIMIT_FSIZE, 100'000,
                          [&] {
                            return thrown_by([&] {
                              Database database(folder / "large.db");
                              database.execute("CREATE TABLE t (b BLOB); INSERT INTO t VALUES (zeroblob(300000))");
                            });
                          }),
              AllOf(HasSubstr("ulimit -f"), Not(HasSubstr("disk I/O error"))));
}

TEST(AccountLimits, MemoryAndThreadsAreNamed) {
  EXPECT_THAT(under_limit(RLIMIT_AS, 500'000'000, [] { return reason_of(std::bad_alloc()); }),
              HasSubstr("a program may have 500 MB here (ulimit -v)"));
  EXPECT_THAT(under_limit(RLIMIT_NPROC, 7, [] { return no_thread_text(); }),
              HasSubstr("a user may have 7 processes and threads here (ulimit -u)"));
}

}  // namespace
}  // namespace rumi
