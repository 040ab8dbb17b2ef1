// SPDX-License-Identifier: BSD-3-Clause
// An OpenGL 3.3 core context without a window or display server, from OSMesa, or from EGL if there is no OSMesa
// (gl_platform.h). The environment variable RUMI_OPENGL (osmesa or egl) chooses one.
#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>

namespace rumi::viewer_offscreen {

class OffscreenContext {
 public:
  // Draws into a colour and depth image of its own. `samples`: 0, or 4 for multisampling. Throws std::runtime_error
  // with the reason if there is no OpenGL.
  OffscreenContext(int width, int height, int samples);
  ~OffscreenContext();
  OffscreenContext(const OffscreenContext&) = delete;
  OffscreenContext& operator=(const OffscreenContext&) = delete;

  // Must be called before any OpenGL call; several contexts may take turns on one thread.
  void make_current();
  // Reads what was drawn, as RGBA of 8 bits. Row 0 is the window's row y = 0: to get an image whose first row is its
  // top, draw upside down (positive clip y is downwards).
  void read(cv::Mat* rgba);

  std::string platform() const;  // "osmesa" or "egl"
  int width() const { return width_; }
  int height() const { return height_; }

 private:
  struct Handle;
  std::unique_ptr<Handle> handle_;
  int width_, height_;
};

// Returns a linked program. Throws std::runtime_error with the compiler's log. The context must be current.
unsigned compile_program(const std::string& vertex_shader, const std::string& fragment_shader);

}  // namespace rumi::viewer_offscreen
