// SPDX-License-Identifier: BSD-3-Clause
// Makes files for tests, and a file system that is soon full.
#pragma once

#include <fcntl.h>
#include <fmt/format.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <stdexcept>
#include <string>

namespace rumi::testing {

inline std::string read_file(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

// Writes a file, and makes the folders in which it lies.
inline void write_file(const std::filesystem::path& file, const std::string& text) {
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << text;
}

class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "rumi_test_XXXXXX").string();
    if (!mkdtemp(name.data())) throw std::runtime_error("cannot create a temporary folder");
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  const std::filesystem::path& path() const { return path_; }
  // Writes a file in the folder. Returns its whole name.
  std::string write(const std::string& name, const std::string& text) const {
    write_file(*this / name, text);
    return *this / name;
  }

 private:
  std::filesystem::path path_;
};

namespace internal {

inline void write_once(const char* file, const std::string& text) {
  const int fd = open(file, O_WRONLY);
  if (fd < 0) return;
  if (write(fd, text.data(), text.size()) < 0) std::perror(file);
  close(fd);
}

inline bool mount_small_disk(const std::string& folder, int64_t bytes) {
  const uid_t uid = getuid();
  const gid_t gid = getgid();
  if (unshare(CLONE_NEWUSER | CLONE_NEWNS) != 0) return false;
  write_once("/proc/self/setgroups", "deny");
  write_once("/proc/self/uid_map", fmt::format("0 {} 1", uid));
  write_once("/proc/self/gid_map", fmt::format("0 {} 1", gid));
  return mount("tmpfs", folder.c_str(), "tmpfs", 0, fmt::format("size={}", bytes).c_str()) == 0;
}

}  // namespace internal

// Runs `body` in a child process in which a file system of `bytes` is mounted on `folder` (`body` may remount it).
// Returns what `body` returns (0..99), or -1 if the system does not allow that.
inline int run_on_small_disk(const std::string& folder, int64_t bytes, const std::function<int()>& body) {
  const pid_t child = fork();
  if (child == 0) {
    if (!internal::mount_small_disk(folder, bytes)) _exit(100);
    int result = 99;
    try {
      result = body();
    } catch (const std::exception& error) {
      std::fprintf(stderr, "on the small disk: %s\n", error.what());
    }
    _exit(result);
  }
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFSIGNALED(status)) std::fprintf(stderr, "on the small disk: signal %d\n", WTERMSIG(status));
  if (!WIFEXITED(status)) return 98;
  return WEXITSTATUS(status) == 100 ? -1 : WEXITSTATUS(status);
}

}  // namespace rumi::testing
