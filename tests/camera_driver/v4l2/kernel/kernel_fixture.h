// SPDX-License-Identifier: BSD-3-Clause
// Shared by the tests against the kernel's cameras: takes the images of a source within a time, and runs the process.
#pragma once

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bus/transport/bus.h"
#include "camera_driver/v4l2/v4l2_source.h"

namespace rumi::testing {

using namespace camera_driver;

inline constexpr int64_t kSecondUs = 1'000'000;

inline int64_t monotonic_us() { return kernel_video_system().now().monotonic_us; }

class CameraSourceTest : public ::testing::Test {
 protected:
  std::string open(const std::string& input) {
    OpenedSource opened = open_camera(kernel_video_system(), input, options_);
    source_ = opened ? std::move(*opened) : nullptr;
    return opened.error_text();
  }
  std::vector<image_t> take(size_t n, int64_t within_us = 20 * kSecondUs) {
    std::vector<image_t> images;
    const int64_t end = monotonic_us() + within_us;
    while (images.size() < n && monotonic_us() < end) {
      std::optional<image_t> image = source_->next();
      if (image) images.push_back(std::move(*image));
    }
    return images;
  }
  bool wait_for(const std::function<bool()>& condition, int64_t within_us = 20 * kSecondUs) {
    const int64_t end = monotonic_us() + within_us;
    while (!condition() && monotonic_us() < end) source_->next();
    return condition();
  }
  CameraOptions options_;
  std::unique_ptr<ImageSource> source_;
};

// Dispatches the bus until the condition is true; false if it never is. The limit is for a slow machine: without KVM a
// process may take half a minute to start.
inline bool hear_until(Bus& bus, const std::function<bool()>& condition) {
  const int64_t end = monotonic_us() + 120 * kSecondUs;
  while (!condition() && monotonic_us() < end) bus.dispatch(100);
  return condition();
}

// Runs camera_driver as a user starts it.
class Process {
 public:
  explicit Process(const std::vector<std::string>& arguments) {
    std::vector<char*> argv = {const_cast<char*>(CAMERA_DRIVER)};
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    pid_ = fork();
    if (pid_ == 0) {
      execv(argv[0], argv.data());
      _exit(127);
    }
  }
  ~Process() {
    if (pid_ > 0) end(SIGKILL);
  }
  void signal(int number) const { kill(pid_, number); }
  int end(int number) {
    int status = 0;
    kill(pid_, number);
    waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }

 private:
  pid_t pid_ = -1;
};

}  // namespace rumi::testing
