// SPDX-License-Identifier: BSD-3-Clause
#include "viewer_offscreen/gl/offscreen_context.h"

#include <array>
#include <cstdlib>
#include <future>
#include <opencv2/core/utility.hpp>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <vector>

#include "base/this_process/account_limits.h"
#include "viewer_offscreen/gl/gl.h"
#include "viewer_offscreen/gl/gl_platform.h"

namespace rumi::viewer_offscreen {

#define RUMI_DEFINE(type, name) type name = nullptr;
RUMI_GL_FUNCTIONS(RUMI_DEFINE)
#undef RUMI_DEFINE

// All drawing goes into framebuffer objects of our own, because these can be multisampled.
struct OffscreenContext::Handle {
  std::unique_ptr<GlPlatform> platform;
  GLuint draw = 0, resolved = 0;
  std::array<GLuint, 4> buffers{};
};

namespace {

// Lets Mesa's llvmpipe draw without threads. If it cannot have a thread (a limit of processes or of memory), it waits
// for it for ever. Without threads it draws the same, and pictures of our size as fast. A value that the user has set
// stays.
void draw_without_threads() {
  static const int once = setenv("LP_NUM_THREADS", "0", /*overwrite=*/0);
  (void)once;
}

bool can_have_threads(int count) {
  std::vector<std::thread> threads;
  std::promise<void> end;
  const std::shared_future<void> ended = end.get_future();
  bool all = true;
  try {
    for (int i = 0; i < count; ++i) threads.emplace_back([ended] { ended.wait(); });
  } catch (const std::system_error&) {
    all = false;
  }
  end.set_value();
  for (std::thread& thread : threads) thread.join();
  return all;
}

// Lets OpenCV work without threads if it could not start its own: it would throw while it prepares a picture.
void spare_threads_of_opencv() {
  static const bool can = can_have_threads(cv::getNumThreads());
  if (!can) cv::setNumThreads(1);
}

std::unique_ptr<GlPlatform> open_platform() {
  draw_without_threads();
  spare_threads_of_opencv();
  const char* variable = std::getenv("RUMI_OPENGL");
  const std::string wanted = variable ? variable : "";
  if (wanted == "osmesa") return open_osmesa();
  if (wanted == "egl") return open_egl();
  if (!wanted.empty()) throw std::runtime_error("RUMI_OPENGL is '" + wanted + "', must be osmesa or egl");
  std::string reasons;
  for (const auto open : {open_osmesa, open_egl}) {
    try {
      return open();
    } catch (const std::runtime_error& e) {
      reasons += std::string(reasons.empty() ? "" : "; ") + e.what();
    }
  }
  throw std::runtime_error("no OpenGL: " + reasons);
}

// Loads the function pointers from the platform, whose context is current.
void load_functions(const GlPlatform& platform) {
  static std::string loaded_from;
  if (loaded_from == platform.name()) return;
  loaded_from.clear();
#define RUMI_LOAD(Type, gl)                            \
  gl = reinterpret_cast<Type>(platform.function(#gl)); \
  if (!(gl)) throw std::runtime_error(std::string(platform.name()) + " has no " #gl);
  RUMI_GL_FUNCTIONS(RUMI_LOAD)
#undef RUMI_LOAD
  loaded_from = platform.name();
}

void check_complete() {
  const GLenum status = glCheckFramebufferStatus(GL_FRAMEBUFFER);
  // An incomplete attachment is a buffer that was requested just now and not allocated.
  if (status == GL_FRAMEBUFFER_INCOMPLETE_ATTACHMENT)
    throw std::runtime_error("OpenGL gives no image to draw into: " + no_memory_text());
  if (status != GL_FRAMEBUFFER_COMPLETE)
    throw std::runtime_error("OpenGL framebuffer is incomplete, status " + std::to_string(status));
}

GLuint compile(GLenum type, const std::string& source) {
  const GLuint shader = glCreateShader(type);
  const char* text = source.c_str();
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  GLint ok = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
  if (!ok) {
    std::vector<char> log(4096);
    glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
    throw std::runtime_error(std::string("shader does not compile: ") + log.data());
  }
  return shader;
}

}  // namespace

OffscreenContext::OffscreenContext(int width, int height, int samples)
    : handle_(std::make_unique<Handle>()), width_(width), height_(height) {
  handle_->platform = open_platform();
  make_current();

  glGenRenderbuffers(4, handle_->buffers.data());
  const auto storage = [&](GLuint buffer, GLenum format, int n) {
    glBindRenderbuffer(GL_RENDERBUFFER, buffer);
    glRenderbufferStorageMultisample(GL_RENDERBUFFER, n, format, width, height);
  };
  storage(handle_->buffers[0], GL_RGBA8, samples);
  storage(handle_->buffers[1], GL_DEPTH_COMPONENT32F, samples);
  glGenFramebuffers(1, &handle_->draw);
  glBindFramebuffer(GL_FRAMEBUFFER, handle_->draw);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, handle_->buffers[0]);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, handle_->buffers[1]);
  check_complete();
  handle_->resolved = handle_->draw;
  if (samples > 0) {
    storage(handle_->buffers[2], GL_RGBA8, 0);
    glGenFramebuffers(1, &handle_->resolved);
    glBindFramebuffer(GL_FRAMEBUFFER, handle_->resolved);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, handle_->buffers[2]);
    check_complete();
  }
  make_current();
}

OffscreenContext::~OffscreenContext() = default;

std::string OffscreenContext::platform() const { return handle_->platform->name(); }

void OffscreenContext::make_current() {
  handle_->platform->make_current();
  load_functions(*handle_->platform);
  if (handle_->draw) glBindFramebuffer(GL_FRAMEBUFFER, handle_->draw);
  glViewport(0, 0, width_, height_);
}

void OffscreenContext::read(cv::Mat* rgba) {
  rgba->create(height_, width_, CV_8UC4);
  if (handle_->resolved != handle_->draw) {
    glBindFramebuffer(GL_READ_FRAMEBUFFER, handle_->draw);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, handle_->resolved);
    glBlitFramebuffer(0, 0, width_, height_, 0, 0, width_, height_, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  }
  glBindFramebuffer(GL_READ_FRAMEBUFFER, handle_->resolved);
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, rgba->data);
  glBindFramebuffer(GL_FRAMEBUFFER, handle_->draw);
}

unsigned compile_program(const std::string& vertex_shader, const std::string& fragment_shader) {
  const GLuint program = glCreateProgram();
  const GLuint vertex = compile(GL_VERTEX_SHADER, vertex_shader);
  const GLuint fragment = compile(GL_FRAGMENT_SHADER, fragment_shader);
  glAttachShader(program, vertex);
  glAttachShader(program, fragment);
  glLinkProgram(program);
  glDeleteShader(vertex);
  glDeleteShader(fragment);
  GLint ok = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &ok);
  if (!ok) {
    std::vector<char> log(4096);
    glGetProgramInfoLog(program, static_cast<GLsizei>(log.size()), nullptr, log.data());
    throw std::runtime_error(std::string("shaders do not link: ") + log.data());
  }
  return program;
}

}  // namespace rumi::viewer_offscreen
