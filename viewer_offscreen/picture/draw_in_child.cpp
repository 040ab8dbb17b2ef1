// SPDX-License-Identifier: BSD-3-Clause
#include "viewer_offscreen/picture/draw_in_child.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <exception>
#include <string>

#include "base/files/file_descriptor.h"

namespace rumi::viewer_offscreen {
namespace {

constexpr size_t kMostText = 1000;

// Memory that this process and its child both see: the picture, and why there is none.
class SharedPicture {
 public:
  explicit SharedPicture(const cv::Size& size) : size_(size) {
    memory_ = mmap(nullptr, bytes(), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  }
  ~SharedPicture() {
    if (is_there()) munmap(memory_, bytes());
  }
  SharedPicture(const SharedPicture&) = delete;
  SharedPicture& operator=(const SharedPicture&) = delete;

  bool is_there() const { return memory_ != MAP_FAILED; }
  char* text() const { return static_cast<char*>(memory_); }
  cv::Mat picture() const { return {size_, CV_8UC3, static_cast<char*>(memory_) + kMostText}; }

 private:
  size_t bytes() const { return kMostText + 3 * static_cast<size_t>(size_.area()); }
  cv::Size size_;
  void* memory_ = nullptr;
};

// Runs in the child. Returns its exit code.
int draw_into(const SharedPicture& shared, const std::function<cv::Mat()>& draw) {
  std::string why;
  try {
    const cv::Mat drawn = draw();
    cv::Mat picture = shared.picture();
    if (drawn.size() == picture.size() && drawn.type() == picture.type()) {
      drawn.copyTo(picture);
      return 0;
    }
    why = fmt::format("the picture has {} x {} pixels", drawn.cols, drawn.rows);
  } catch (const std::exception& e) {
    why = e.what();
  }
  std::strncpy(shared.text(), why.c_str(), kMostText - 1);
  return 1;
}

// Waits until the child has ended, and kills it if that takes too long. `ended` is readable when it has.
Result<> wait_for(pid_t child, int ended, double timeout_s, const SharedPicture& shared) {
  pollfd events{.fd = ended, .events = POLLIN, .revents = 0};
  int ready = 0;
  while ((ready = poll(&events, 1, static_cast<int>(1e3 * timeout_s))) < 0 && errno == EINTR) {
  }
  if (ready == 0) kill(child, SIGKILL);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (ready == 0) return Error{fmt::format("a picture is not drawn: it took longer than {:.0f} s", timeout_s)};
  if (WIFSIGNALED(status)) return Error{fmt::format("a picture is not drawn: signal {}", WTERMSIG(status))};
  if (status != 0) return Error{shared.text()};
  return {};
}

}  // namespace

Result<cv::Mat> draw_in_child(const cv::Size& size, const std::function<cv::Mat()>& draw, double timeout_s) {
  const SharedPicture shared(size);
  std::array<int, 2> ends{};
  if (!shared.is_there() || pipe2(ends.data(), O_CLOEXEC) != 0)
    return Error{fmt::format("a picture is not drawn: {}", std::strerror(errno))};
  FileDescriptor ended(ends[0]), open_in_child(ends[1]);
  const pid_t parent = getpid(), child = fork();
  if (child == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    // _exit() runs no destructors: those of the parent's objects are not the child's to run.
    _exit(getppid() == parent ? draw_into(shared, draw) : 1);
  }
  if (child < 0) return Error{fmt::format("a picture is not drawn: {}", std::strerror(errno))};
  open_in_child.reset();
  if (const Result<> waited = wait_for(child, ended.get(), timeout_s, shared); !waited) return waited.error();
  return shared.picture().clone();
}

}  // namespace rumi::viewer_offscreen
