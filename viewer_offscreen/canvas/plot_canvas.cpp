// SPDX-License-Identifier: BSD-3-Clause
#include "viewer_offscreen/canvas/plot_canvas.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <opencv2/imgproc.hpp>

#include "viewer_offscreen/gl/gl.h"

namespace rumi::viewer_offscreen {
namespace {

constexpr size_t kBatch = 600'000;  // corners sent to OpenGL at once, at most

const char* const kVertexShader = R"(#version 330 core
layout(location = 0) in vec2 position;
layout(location = 1) in vec3 shape;
layout(location = 2) in vec4 ink;
out vec3 f_shape;
flat out vec4 f_ink;
void main() {
  gl_Position = vec4(position, 0.0, 1.0);
  f_shape = shape;
  f_ink = ink;
})";

// Spreads the edge of a shape over one pixel.
const char* const kFragmentShader = R"(#version 330 core
in vec3 f_shape;
flat in vec4 f_ink;
out vec4 colour;
void main() {
  float cover = clamp((1.0 - length(f_shape.xy)) * f_shape.z + 0.5, 0.0, 1.0);
  colour = vec4(f_ink.rgb, f_ink.a * cover);
})";

const char* const kPointVertexShader = R"(#version 330 core
uniform mat4 clip_from_map;
layout(location = 0) in vec3 position;
void main() {
  gl_Position = clip_from_map * vec4(position, 1.0);
})";

const char* const kPointFragmentShader = R"(#version 330 core
uniform vec4 ink;
out vec4 colour;
void main() {
  colour = ink;
})";

void attribute(GLuint location, GLint components, GLenum type, bool normalized, size_t stride, size_t offset) {
  glEnableVertexAttribArray(location);
  glVertexAttribPointer(location, components, type, normalized ? GL_TRUE : GL_FALSE, static_cast<GLsizei>(stride),
                        reinterpret_cast<const void*>(offset));
}

}  // namespace

PlotCanvas::PlotCanvas(int width, int height) : context_(width * kScale, height * kScale, 0) {
  program_ = compile_program(kVertexShader, kFragmentShader);
  glGenVertexArrays(1, &vertex_array_);
  glBindVertexArray(vertex_array_);
  glGenBuffers(1, &buffer_);
  glBindBuffer(GL_ARRAY_BUFFER, buffer_);
  attribute(0, 2, GL_FLOAT, false, sizeof(Corner), offsetof(Corner, x));
  attribute(1, 3, GL_FLOAT, false, sizeof(Corner), offsetof(Corner, u));
  attribute(2, 4, GL_UNSIGNED_BYTE, true, sizeof(Corner), offsetof(Corner, rgba));
  point_program_ = compile_program(kPointVertexShader, kPointFragmentShader);
  glGenVertexArrays(1, &point_array_);
  glGenBuffers(1, &point_buffer_);
}

void PlotCanvas::clear(const cv::Vec3b& rgb) {
  context_.make_current();
  corners_.clear();
  glDisable(GL_SCISSOR_TEST);
  glClearColor(rgb[0] / 255.f, rgb[1] / 255.f, rgb[2] / 255.f, 1);
  glClear(GL_COLOR_BUFFER_BIT);
}

void PlotCanvas::clip(const cv::Rect& panel) {
  flush();
  glEnable(GL_SCISSOR_TEST);
  glScissor(panel.x * kScale, panel.y * kScale, panel.width * kScale, panel.height * kScale);
}

void PlotCanvas::unclip() {
  flush();
  glDisable(GL_SCISSOR_TEST);
}

void PlotCanvas::corner(cv::Point2d at, float u, float v, double half_width, const Ink& ink) {
  Corner c{};
  // Positive clip y is downwards in the image: see OffscreenContext::read.
  c.x = static_cast<float>(2 * kScale * at.x / context_.width() - 1);
  c.y = static_cast<float>(2 * kScale * at.y / context_.height() - 1);
  c.u = u;
  c.v = v;
  c.half_width = static_cast<float>(half_width);
  for (int i = 0; i < 3; ++i) c.rgba[i] = ink.rgb[i];
  c.rgba[3] = static_cast<uint8_t>(std::lround(255 * std::clamp(ink.alpha, 0.0, 1.0)));
  corners_.push_back(c);
}

void PlotCanvas::quad(const cv::Point2d (&at)[4], double half_width, bool round, const Ink& ink) {
  if (corners_.size() >= kBatch) flush();
  static constexpr float kU[] = {-1, 1, 1, -1}, kV[] = {-1, -1, 1, 1};
  for (const int i : {0, 1, 2, 0, 2, 3}) corner(at[i], round ? kU[i] : 0, kV[i], half_width, ink);
}

void PlotCanvas::disc(cv::Point2d center, double radius, const Ink& ink) {
  const double r = radius + 0.5 / kScale;  // room for the soft edge
  quad({center + cv::Point2d(-r, -r), center + cv::Point2d(r, -r), center + cv::Point2d(r, r),
        center + cv::Point2d(-r, r)},
       r * kScale, true, ink);
}

void PlotCanvas::line(cv::Point2d a, cv::Point2d b, double width, const Ink& ink) {
  const cv::Point2d along = b - a;
  const double length = std::hypot(along.x, along.y);
  if (!(length > 0) || !std::isfinite(length)) return;
  const double half = width / 2 + 0.5 / kScale;
  const cv::Point2d side(-along.y / length * half, along.x / length * half);
  quad({a - side, b - side, b + side, a + side}, half * kScale, false, ink);
}

void PlotCanvas::dashed(cv::Point2d a, cv::Point2d b, double width, double dash, const Ink& ink) {
  const double length = std::hypot(b.x - a.x, b.y - a.y);
  if (!std::isfinite(length) || length > 1e5) return;
  for (double at = 0; at < length; at += 2 * dash)
    line(a + (b - a) * (at / length), a + (b - a) * (std::min(at + dash, length) / length), width, ink);
}

void PlotCanvas::rectangle(const cv::Rect2d& area, const Ink& ink) {
  const cv::Point2d a = area.tl(), b = area.br();
  triangle(a, {b.x, a.y}, b, ink);
  triangle(a, b, {a.x, b.y}, ink);
}

void PlotCanvas::triangle(cv::Point2d a, cv::Point2d b, cv::Point2d c, const Ink& ink) {
  if (corners_.size() >= kBatch) flush();
  for (const cv::Point2d& at : {a, b, c}) corner(at, 0, 0, 1, ink);
}

void PlotCanvas::flush() {
  context_.make_current();
  if (corners_.empty()) return;
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glUseProgram(program_);
  glBindVertexArray(vertex_array_);
  glBindBuffer(GL_ARRAY_BUFFER, buffer_);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(corners_.size() * sizeof(Corner)), corners_.data(),
               GL_STREAM_DRAW);
  glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(corners_.size()));
  corners_.clear();
}

void PlotCanvas::set_points(const std::vector<Eigen::Vector3f>& points) {
  context_.make_current();
  glBindBuffer(GL_ARRAY_BUFFER, point_buffer_);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(points.size() * sizeof(points[0])), points.data(),
               GL_STREAM_DRAW);
}

void PlotCanvas::points(size_t first, size_t count, size_t step, const Projection& project, double size,
                        const Ink& ink) {
  flush();
  if (count == 0) return;
  Eigen::Matrix4d clip = Eigen::Matrix4d::Zero();
  const Projection::Matrix& m = project.matrix();
  clip.row(0) = 2.0 * kScale / context_.width() * m.row(0) - m.row(2);
  clip.row(1) = 2.0 * kScale / context_.height() * m.row(1) - m.row(2);
  clip.row(3) = m.row(2);
  const Eigen::Matrix4f clip_from_map = clip.cast<float>();
  glUseProgram(point_program_);
  glUniformMatrix4fv(glGetUniformLocation(point_program_, "clip_from_map"), 1, GL_FALSE, clip_from_map.data());
  glUniform4f(glGetUniformLocation(point_program_, "ink"), ink.rgb[0] / 255.f, ink.rgb[1] / 255.f, ink.rgb[2] / 255.f,
              static_cast<float>(ink.alpha));
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glPointSize(static_cast<float>(size * kScale));
  glBindVertexArray(point_array_);
  glBindBuffer(GL_ARRAY_BUFFER, point_buffer_);
  attribute(0, 3, GL_FLOAT, false, step * sizeof(Eigen::Vector3f), first * sizeof(Eigen::Vector3f));
  glDrawArrays(GL_POINTS, 0, static_cast<GLsizei>((count + step - 1) / step));
}

cv::Mat PlotCanvas::read() {
  flush();
  cv::Mat rgba, bgr;
  context_.read(&rgba);
  cv::cvtColor(rgba, bgr, cv::COLOR_RGBA2BGR);
  return bgr;
}

}  // namespace rumi::viewer_offscreen
