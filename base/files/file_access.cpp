// SPDX-License-Identifier: BSD-3-Clause
#include "base/files/file_access.h"

#include <fmt/format.h>
#include <pwd.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace rumi {
namespace {

namespace fs = std::filesystem;

bool is_folder(const fs::path& path) {
  std::error_code code;
  return fs::is_directory(path, code);
}

// Returns the outermost folder on the way to `path` that this process has no permission to enter; empty if there is no
// such folder.
fs::path closed_folder(const fs::path& path) {
  fs::path folder;
  for (const fs::path& part : fs::absolute(path).parent_path()) {
    folder /= part;
    if (access(folder.c_str(), X_OK) != 0 && errno == EACCES) return folder;
  }
  return {};
}

std::string user_name(uid_t uid) {
  const passwd* entry = getpwuid(uid);
  return entry ? fmt::format("{} (uid {})", entry->pw_name, uid) : fmt::format("uid {}", uid);
}

}  // namespace

std::string note_on_owner(const fs::path& path) {
  struct stat info {};
  std::error_code code;
  const fs::path there = fs::exists(path, code) ? path : fs::absolute(path).parent_path();
  if (stat(there.c_str(), &info) != 0 || info.st_uid == geteuid()) return {};
  return fmt::format("; {} belongs to {}, and this is {}", there.string(), user_name(info.st_uid),
                     user_name(geteuid()));
}

std::string why_unreadable(const fs::path& path, const std::string& remedy) {
  if (access(path.c_str(), is_folder(path) ? R_OK | X_OK : R_OK) == 0) return "";
  const int code = errno;
  if (code == ENOENT || code == ENOTDIR) return "no such file or folder" + (remedy.empty() ? "" : "; " + remedy);
  if (code != EACCES) return std::strerror(code);
  const fs::path closed = closed_folder(path);
  const std::string what = closed.empty() ? "read it" : fmt::format("enter the folder {}", closed.string());
  const fs::path whose = closed.empty() ? path : closed;
  return fmt::format("no permission to {}; its owner can give it with `chmod {} {}`", what,
                     is_folder(whose) ? "a+rx" : "a+r", whose.string());
}

bool may_be_there(const fs::path& path) { return access(path.c_str(), F_OK) == 0 || errno == EACCES; }

}  // namespace rumi
