// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/store/database_lock.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace rumi::map_server {

DatabaseLock::DatabaseLock(const std::string& database) : file_(file_of(database)), lock_(FileLock::take(file_)) {
  if (lock_) {
    lock_->sign();
    return;
  }
  if (errno != EWOULDBLOCK)
    throw std::runtime_error(
        fmt::format("cannot create {}: {}; the folder must exist and be writable", file_, std::strerror(errno)));
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
