// SPDX-License-Identifier: BSD-3-Clause
#include "viewer_offscreen/offscreen_context.h"

#define GL_GLEXT_PROTOTYPES
#include <GL/osmesa.h>

#include <array>
#include <stdexcept>
#include <vector>

namespace rumi {

struct OffscreenContext::Handle {
  OSMesaContext context = nullptr;
  // OSMesa wants a window of its own; everything is drawn into framebuffer objects instead, which can be multisampled.
  std::array<unsigned char, 4 * 16 * 16> window{};
  GLuint draw = 0, resolved = 0;
  std::array<GLuint, 4> buffers{};
  ~Handle() {
    if (context) OSMesaDestroyContext(context);
  }
};

namespace {

void check_complete() {
  const GLenum status = glCheckFramebufferStatus(GL_FRAMEBUFFER);
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
  const int attributes[] = {OSMESA_FORMAT,
                            OSMESA_RGBA,
                            OSMESA_DEPTH_BITS,
                            0,
                            OSMESA_PROFILE,
                            OSMESA_CORE_PROFILE,
                            OSMESA_CONTEXT_MAJOR_VERSION,
                            3,
                            OSMESA_CONTEXT_MINOR_VERSION,
                            3,
                            0};
  handle_->context = OSMesaCreateContextAttribs(attributes, nullptr);
  if (!handle_->context) throw std::runtime_error("OSMesa gives no OpenGL 3.3 core context");
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

void OffscreenContext::make_current() {
  if (!OSMesaMakeCurrent(handle_->context, handle_->window.data(), GL_UNSIGNED_BYTE, 16, 16))
    throw std::runtime_error("OSMesa cannot make its context current");
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

}  // namespace rumi
