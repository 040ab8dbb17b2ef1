// SPDX-License-Identifier: BSD-3-Clause
#include <fcntl.h>
#include <grp.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>

#include "base/text/natural_order.h"
#include "camera_driver/v4l2/video_system.h"

namespace rumi::camera_driver {
namespace {

namespace fs = std::filesystem;

int64_t clock_us(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return int64_t{time.tv_sec} * 1'000'000 + time.tv_nsec / 1000;
}

class KernelVideoSystem : public VideoSystem {
 public:
  int open(const std::string& path) override {
    const int fd = ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    return fd >= 0 ? fd : -errno;
  }
  void close(int fd) override { ::close(fd); }
  int ioctl(int fd, unsigned long request, void* argument) override {
    int result = 0;
    do {
      result = ::ioctl(fd, request, argument);
    } while (result < 0 && errno == EINTR);
    return result < 0 ? -errno : 0;
  }
  void* map(int fd, size_t length, int64_t offset) override {
    void* start = mmap(nullptr, length, PROT_READ | PROT_WRITE, MAP_SHARED, fd, offset);
    return start == MAP_FAILED ? nullptr : start;
  }
  void unmap(void* start, size_t length) override { munmap(start, length); }
  bool poll(int fd, int timeout_ms) override {
    pollfd item{fd, POLLIN, 0};
    return ::poll(&item, 1, timeout_ms) > 0;
  }
  void wait(int ms) override { ::poll(nullptr, 0, ms); }

  // Reads the system clock between two looks at the monotonic one, and takes the quickest of three attempts: an
  // interruption between the looks would make the pair wrong.
  Clocks now() override {
    Clocks best;
    int64_t best_span_us = INT64_MAX;
    for (int i = 0; i < 3; ++i) {
      const int64_t before = clock_us(CLOCK_MONOTONIC), system = clock_us(CLOCK_REALTIME);
      const int64_t span = clock_us(CLOCK_MONOTONIC) - before;
      if (span >= best_span_us) continue;
      best_span_us = span;
      best = {before + span / 2, system};
    }
    return best;
  }

  std::vector<std::string> devices() override {
    std::vector<std::string> found;
    std::error_code code;
    for (fs::directory_iterator it("/dev", code), end; !code && it != end; it.increment(code)) {
      const std::string name = it->path().filename().string();
      if (name.starts_with("video") && name.find_first_not_of("0123456789", 5) == std::string::npos && name.size() > 5)
        found.push_back(it->path().string());
    }
    std::sort(found.begin(), found.end(), natural_less);
    return found;
  }
  std::vector<std::string> lasting_names(const std::string& device) override {
    std::vector<std::string> found;
    std::error_code code, ignored;
    for (fs::directory_iterator it("/dev/v4l/by-id", code), end; !code && it != end; it.increment(code))
      if (fs::equivalent(it->path(), device, ignored)) found.push_back(it->path().string());
    std::sort(found.begin(), found.end());
    return found;
  }
  std::string group_of(const std::string& path) override {
    struct stat status {};
    if (stat(path.c_str(), &status) != 0) return {};
    const group* entry = getgrgid(status.st_gid);
    return entry ? entry->gr_name : std::to_string(status.st_gid);
  }
};

}  // namespace

VideoSystem& kernel_video_system() {
  static KernelVideoSystem system;
  return system;
}

}  // namespace rumi::camera_driver
