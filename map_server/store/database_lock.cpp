// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/store/database_lock.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "base/files/file_access.h"

namespace rumi::map_server {

namespace {

namespace fs = std::filesystem;

// For a person who has named no folder: it is the one in which the program was started.
std::string why_not_made(const std::string& lock, int reason) {
  const fs::path folder = fs::absolute(lock).parent_path();
  const char* remedy = reason == ENOENT ? "make that folder, or name another file with --set map_server.database=FILE"
                                        : "name another file with --set map_server.database=FILE, or start in a folder "
                                          "that you may write";
  return fmt::format("cannot create {} in the folder {}: {}{}; {}", fs::path(lock).filename().string(), folder.string(),
                     std::strerror(reason), reason == ENOENT ? "" : note_on_owner(folder), remedy);
}

}  // namespace

DatabaseLock::DatabaseLock(const std::string& database) : file_(file_of(database)), lock_(FileLock::take(file_)) {
  if (lock_) {
    lock_->sign();
    return;
  }
  if (const int reason = errno; reason != EWOULDBLOCK) throw std::runtime_error(why_not_made(file_, reason));
  throw std::runtime_error(fmt::format(
      "another map_server (pid {}) has the map open: it holds {}; stop that one or give this one another database",
      holder_of_lock(file_).value_or("unknown"), file_));
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
