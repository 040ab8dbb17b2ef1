// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/store/database_lock.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include "base/files/file_access.h"

namespace rumi::map_server {

namespace {

namespace fs = std::filesystem;

// Returns the error for a lock file that cannot be made. It names the folder, because a user who gave no path may not
// know in which folder the program runs.
Error why_not_made(const std::string& lock, int reason) {
  const fs::path folder = fs::absolute(lock).parent_path();
  const char* remedy = reason == ENOENT ? "make that folder, or name another file with --set map_server.database=FILE"
                                        : "name another file with --set map_server.database=FILE, or start in a folder "
                                          "that you may write";
  return {.what = fmt::format("cannot create {} in the folder {}: {}{}", fs::path(lock).filename().string(),
                              folder.string(), std::strerror(reason), reason == ENOENT ? "" : note_on_owner(folder)),
          .remedy = remedy};
}

}  // namespace

Result<DatabaseLock> DatabaseLock::take(const std::string& database) {
  DatabaseLock lock;
  lock.file_ = file_of(database);
  lock.lock_ = FileLock::take(lock.file_);
  if (lock.lock_) {
    lock.lock_->sign();
    return lock;
  }
  if (const int reason = errno; reason != EWOULDBLOCK) return why_not_made(lock.file_, reason);
  return Error{.what = fmt::format("another map_server (pid {}) has the map open: it holds {}",
                                   holder_of_lock(lock.file_).value_or("unknown"), lock.file_),
               .remedy = "stop that one or give this one another database"};
}

DatabaseLock::~DatabaseLock() {
  if (lock_) ::unlink(file_.c_str());
}

DatabaseLock& DatabaseLock::operator=(DatabaseLock&& other) noexcept {
  std::swap(file_, other.file_);
  std::swap(lock_, other.lock_);
  return *this;
}

}  // namespace rumi::map_server
