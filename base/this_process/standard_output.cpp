// SPDX-License-Identifier: BSD-3-Clause
#include "base/this_process/standard_output.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>

#include "base/this_process/account_limits.h"

namespace rumi {

void hold_standard_streams() {
  for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    // open() takes the lowest free number, which is this one. It opens for the wrong direction, so that using it fails.
    if (fcntl(fd, F_GETFD) < 0 && errno == EBADF) [[maybe_unused]]
      const int same = open("/dev/null", fd == STDIN_FILENO ? O_WRONLY : O_RDONLY);
}

std::string flush_stdout() {
  // stdio remembers that a write failed, but not why.
  static int reason = 0;
  if (std::fflush(stdout) != 0 && reason == 0) reason = errno;
  if (reason == 0 && std::ferror(stdout) != 0) reason = EIO;
  return reason == 0 ? "" : fmt::format("cannot write: {}", write_error_text(reason));
}

}  // namespace rumi
