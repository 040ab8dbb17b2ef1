// SPDX-License-Identifier: BSD-3-Clause
// A library that provides an OpenGL context without a window or display server. It is loaded only when needed, and may
// be missing.
#pragma once

#include <memory>

namespace rumi::viewer_offscreen {

class GlPlatform {
 public:
  using Function = void (*)();

  virtual ~GlPlatform() = default;
  GlPlatform() = default;
  GlPlatform(const GlPlatform&) = delete;
  GlPlatform& operator=(const GlPlatform&) = delete;

  virtual const char* name() const = 0;
  // Throws std::runtime_error if that fails. The context may have no default framebuffer.
  virtual void make_current() = 0;
  virtual Function function(const char* name) const = 0;
};

// Both throw std::runtime_error with the reason if there is no OpenGL 3.3 core.
std::unique_ptr<GlPlatform> open_osmesa();  // Mesa's software renderer as a library; Mesa 25.1 has dropped it
std::unique_ptr<GlPlatform> open_egl();     // EGL on Mesa's surfaceless platform: a GPU, or the software renderer

}  // namespace rumi::viewer_offscreen
