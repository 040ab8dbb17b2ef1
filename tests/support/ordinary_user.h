// SPDX-License-Identifier: BSD-3-Clause
// Runs tests of permissions as another user: root, who often runs tests, is not bound by permissions.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <functional>
#include <string>

namespace rumi::testing {

// Returns what `work` returns in a child process that does not run as root.
inline std::string as_ordinary_user(const std::function<std::string()>& work) {
  constexpr unsigned kNobody = 65534;
  int ends[2];
  if (pipe(ends) != 0) return "no pipe";
  const pid_t child = fork();
  if (child == 0) {
    const bool was_root = geteuid() == 0;
    if (was_root && (setgid(kNobody) != 0 || setuid(kNobody) != 0)) _exit(1);
    const std::string text = work();
    const bool told = write(ends[1], text.data(), text.size()) == static_cast<ssize_t>(text.size());
    _exit(told ? 0 : 1);
  }
  close(ends[1]);
  std::string text;
  char buffer[4096];
  for (ssize_t n; (n = read(ends[0], buffer, sizeof(buffer))) > 0;) text.append(buffer, static_cast<size_t>(n));
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  return status == 0 ? text : "could not be tried";
}

}  // namespace rumi::testing
