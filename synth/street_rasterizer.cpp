// SPDX-License-Identifier: BSD-3-Clause
#include "synth/street_rasterizer.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "synth/mesh_upload.h"
#include "viewer_offscreen/gl/gl.h"

namespace rumi::synth {

using namespace viewer_offscreen;  // OpenGL's functions
using Eigen::Vector3d;

namespace {

constexpr double kNear_m = 0.2, kFar_m = 420;
constexpr double kHazePerM = 1 / 900.0;
constexpr int kSmallImage = 10;  // its sides are shorter by this

const char* const kVertexShader = R"(
uniform mat4 clip_from_street;
uniform vec4 camera;      // position
uniform vec4 shadow_map;  // low corner, 1 / size
uniform float haze_per_m;
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 uv_layer;
layout(location = 2) in float light;
layout(location = 3) in vec4 dark;
layout(location = 4) in vec4 bright;
layout(location = 5) in vec3 accent;
out vec3 f_uv;
out vec4 f_light;  // of the sky, of the sun, whether the map of shadows applies, haze
out vec2 f_map;
flat out vec3 f_dark, f_bright, f_accent;
void main() {
  gl_Position = clip_from_street * vec4(position, 1.0);
  f_uv = uv_layer;
  f_light = vec4(light, dark.a * 1.5, bright.a, 1.0 - exp(-haze_per_m * distance(position, camera.xyz)));
  f_map = (position.xy - shadow_map.xy) * shadow_map.zw;
  f_dark = dark.rgb;
  f_bright = bright.rgb;
  f_accent = accent;
})";

const char* const kFragmentShader = R"(
uniform sampler2DArray atlas;
uniform sampler2DArray shadows;
uniform float blankness;
in vec3 f_uv;
in vec4 f_light;
in vec2 f_map;
flat in vec3 f_dark, f_bright, f_accent;
out vec4 colour;
void main() {
  vec2 t = texture(atlas, f_uv, -0.5).rg;
#ifdef HOLES
  if (t.g > 0.5) discard;
  vec3 paint = mix(f_dark, f_bright, t.r);
#else
#ifdef GROUND
  // Near the camera a picture of asphalt, turned and much smaller, adds grain that the ground's own picture is too
  // coarse for.
  vec2 grain_at = mat2(4.1, 3.3, -3.3, 4.1) * f_uv.xy;
  float near = clamp(1.0 + 36.0 * log(1.0 - f_light.w), 0.0, 1.0);
  t.r = clamp(t.r + near * 0.55 * (texture(atlas, vec3(grain_at, 0.0), -0.5).r - 0.43), 0.0, 1.0);
#endif
  vec3 paint = mix(mix(f_dark, f_bright, t.r), f_accent, t.g * 0.85);
#endif
  float sun = f_light.y * mix(1.0, texture(shadows, vec3(f_map, 0.0)).r, f_light.z);
  vec3 seen = mix(paint * (f_light.x + sun) * 0.6, vec3(0.66, 0.69, 0.73), f_light.w);
  colour = vec4(mix(seen, vec3(0.42), blankness), 1.0);
})";

double sight_m(DrawnAs drawn_as) {
  switch (drawn_as) {
    case DrawnAs::kGround:
      return 170;
    case DrawnAs::kFar:
      return kFar_m;
    case DrawnAs::kNear:
      return 130;
    case DrawnAs::kSmall:
    case DrawnAs::kMarks:
      return 80;
    case DrawnAs::kLeaves:
      return 100;
    case DrawnAs::kFarLeaves:
      break;
  }
  return 200;
}

void upload_shadows(const cv::Mat& shadows) {
  const cv::Mat whole = shadows.clone();
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage3D(GL_TEXTURE_2D_ARRAY, 0, GL_R8, whole.cols, whole.rows, 1, 0, GL_RED, GL_UNSIGNED_BYTE, whole.data);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTexParameteri(GL_TEXTURE_2D_ARRAY, filter, GL_LINEAR);
  for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    glTexParameteri(GL_TEXTURE_2D_ARRAY, wrap, GL_CLAMP_TO_EDGE);
}

}  // namespace

StreetRasterizer::StreetRasterizer(StreetPicture picture, const Camera& pinhole)
    : context_(pinhole.width, pinhole.height, 4),
      camera_(pinhole),
      parts_(std::move(picture.mesh.parts)),
      frustum_(frustum_normals(pinhole)) {
  const Eigen::Vector2d size(picture.shadows.cols * picture.shadows_cell_m,
                             picture.shadows.rows * picture.shadows_cell_m);
  shadow_map_ << picture.shadows_low, size.cwiseInverse();
  solid_ = compile(nullptr);
  ground_ = compile("GROUND");
  with_holes_ = compile("HOLES");
  unsigned ignored = 0;
  const Triangles still{std::move(picture.mesh.vertices), std::move(picture.mesh.indices)};
  still_ = make_buffers(&still, &ignored, &ignored);
  sky_ = make_buffers(&picture.sky, &ignored, &ignored);
  sky_indices_ = static_cast<int>(picture.sky.indices.size());
  const Triangles none;
  moving_ = make_buffers(&none, &moving_vertices_, &moving_indices_);
  glActiveTexture(GL_TEXTURE1);
  glGenTextures(1, &shadows_);
  glBindTexture(GL_TEXTURE_2D_ARRAY, shadows_);
  upload_shadows(picture.shadows);
  glActiveTexture(GL_TEXTURE0);
  glGenTextures(1, &atlas_);
  glBindTexture(GL_TEXTURE_2D_ARRAY, atlas_);
  upload_textures(std::move(picture.layers), GL_REPEAT);
}

StreetRasterizer::~StreetRasterizer() = default;  // the context destroys all objects of OpenGL

StreetRasterizer::Program StreetRasterizer::compile(const char* define) const {
  const std::string head = std::string("#version 330 core\n") + (define ? std::string("#define ") + define + "\n" : "");
  Program p{.id = compile_program(head + kVertexShader, head + kFragmentShader)};
  p.clip = glGetUniformLocation(p.id, "clip_from_street");
  p.camera = glGetUniformLocation(p.id, "camera");
  p.blankness = glGetUniformLocation(p.id, "blankness");
  p.haze = glGetUniformLocation(p.id, "haze_per_m");
  glUseProgram(p.id);
  glUniform1i(glGetUniformLocation(p.id, "atlas"), 0);
  glUniform1i(glGetUniformLocation(p.id, "shadows"), 1);
  const Eigen::Vector4f map = shadow_map_.cast<float>();
  glUniform4f(glGetUniformLocation(p.id, "shadow_map"), map[0], map[1], map[2], map[3]);
  return p;
}

unsigned StreetRasterizer::make_buffers(const Triangles* triangles, unsigned* vertex_buffer, unsigned* index_buffer) {
  GLuint array = 0;
  glGenVertexArrays(1, &array);
  glBindVertexArray(array);
  *vertex_buffer = upload_vertices(triangles->vertices);
  *index_buffer = upload_indices(triangles->indices);
  attribute(0, 3, GL_FLOAT, false, offsetof(Vertex, position));
  attribute(1, 3, GL_FLOAT, false, offsetof(Vertex, uv));
  attribute(2, 1, GL_FLOAT, false, offsetof(Vertex, light));
  attribute(3, 4, GL_UNSIGNED_BYTE, true, offsetof(Vertex, dark));
  attribute(4, 4, GL_UNSIGNED_BYTE, true, offsetof(Vertex, bright));
  attribute(5, 3, GL_UNSIGNED_BYTE, true, offsetof(Vertex, accent));
  return array;
}

bool StreetRasterizer::in_sight(const StreetPart& part, const SE3& cam_from_street, const Vector3d& camera) const {
  const Vector3d nearest = camera.cwiseMax(part.low).cwiseMin(part.high);
  if ((nearest - camera).norm() > sight_m(part.drawn_as)) return false;
  return is_in_frustum(frustum_, part.low, part.high, cam_from_street);
}

// Draws the nearest parts first, because what they hide then costs nothing.
void StreetRasterizer::draw_parts(const SE3& cam_from_street, std::initializer_list<DrawnAs> kinds) {
  const Vector3d camera = cam_from_street.center();
  std::vector<std::pair<double, const StreetPart*>> seen;
  for (const StreetPart& part : parts_)
    if (std::find(kinds.begin(), kinds.end(), part.drawn_as) != kinds.end() && in_sight(part, cam_from_street, camera))
      seen.emplace_back((camera.cwiseMax(part.low).cwiseMin(part.high) - camera).norm(), &part);
  std::stable_sort(seen.begin(), seen.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<GLsizei> counts;
  std::vector<const void*> offsets;
  for (const auto& [distance, part] : seen) {
    counts.push_back(static_cast<GLsizei>(part->indices));
    offsets.push_back(reinterpret_cast<const void*>(static_cast<size_t>(part->first_index) * sizeof(uint32_t)));
  }
  glBindVertexArray(still_);
  glMultiDrawElements(GL_TRIANGLES, counts.data(), GL_UNSIGNED_INT, offsets.data(),
                      static_cast<GLsizei>(counts.size()));
}

void StreetRasterizer::use(const Program& program, const Eigen::Matrix4d& clip_from_street, const Vector3d& camera,
                           double blankness, double haze_per_m) {
  glUseProgram(program.id);
  const Eigen::Matrix4f clip = clip_from_street.cast<float>();
  glUniformMatrix4fv(program.clip, 1, GL_FALSE, clip.data());
  glUniform4f(program.camera, static_cast<float>(camera.x()), static_cast<float>(camera.y()),
              static_cast<float>(camera.z()), 1);
  glUniform1f(program.blankness, static_cast<float>(blankness));
  glUniform1f(program.haze, static_cast<float>(haze_per_m));
}

void StreetRasterizer::draw_all(const SE3& cam_from_street, const Triangles& moving, double blankness) {
  glClearColor(0.3f, 0.4f, 0.55f, 1);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glEnable(GL_DEPTH_TEST);
  // Front faces are clockwise, but the image is drawn upside down.
  glEnable(GL_CULL_FACE);
  glFrontFace(GL_CCW);
  const Eigen::Matrix4d clip = clip_from_camera(camera_, kNear_m, kFar_m);
  Eigen::Matrix4d view = Eigen::Matrix4d::Identity();
  view.topLeftCorner<3, 3>() = cam_from_street.rotation.toRotationMatrix();
  const Eigen::Matrix4d turned = clip * view;
  view.topRightCorner<3, 1>() = cam_from_street.translation;
  const Vector3d camera = cam_from_street.center();
  const auto draw_other = [](unsigned array, size_t indices) {
    glBindVertexArray(array);
    const GLsizei count = static_cast<GLsizei>(indices);
    const void* begin = nullptr;
    glMultiDrawElements(GL_TRIANGLES, &count, GL_UNSIGNED_INT, &begin, 1);
  };
  use(solid_, clip * view, camera, blankness, kHazePerM);
  if (!moving.indices.empty()) draw_other(moving_, moving.indices.size());
  draw_parts(cam_from_street, {DrawnAs::kFar, DrawnAs::kNear, DrawnAs::kSmall});
  use(ground_, clip * view, camera, blankness, kHazePerM);
  draw_parts(cam_from_street, {DrawnAs::kGround});
  use(with_holes_, clip * view, camera, blankness, kHazePerM);
  draw_parts(cam_from_street, {DrawnAs::kMarks, DrawnAs::kLeaves, DrawnAs::kFarLeaves});
  // The sky moves with the camera.
  use(solid_, turned, Vector3d::Zero(), blankness, 0);
  draw_other(sky_, static_cast<size_t>(sky_indices_));
}

namespace {

void refill(unsigned vertex_array, unsigned vertex_buffer, unsigned index_buffer, const Triangles& triangles) {
  glBindVertexArray(vertex_array);
  glBindBuffer(GL_ARRAY_BUFFER, vertex_buffer);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(triangles.vertices.size() * sizeof(Vertex)),
               triangles.vertices.data(), GL_STREAM_DRAW);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, index_buffer);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(triangles.indices.size() * sizeof(uint32_t)),
               triangles.indices.data(), GL_STREAM_DRAW);
}

}  // namespace

void StreetRasterizer::draw(const SE3& cam_from_street, const Triangles& moving, double blankness, cv::Mat* rgba) {
  context_.make_current();
  if (!moving.indices.empty()) refill(moving_, moving_vertices_, moving_indices_, moving);
  draw_all(cam_from_street, moving, blankness);
  context_.read(rgba);
}

double StreetRasterizer::brightness(const SE3& cam_from_street, const Triangles& moving) {
  context_.make_current();
  if (!moving.indices.empty()) refill(moving_, moving_vertices_, moving_indices_, moving);
  const int width = std::max(8, camera_.width / kSmallImage), height = std::max(8, camera_.height / kSmallImage);
  glViewport(0, 0, width, height);
  draw_all(cam_from_street, moving, 0);
  cv::Mat rgba, grey;
  context_.read(&rgba);
  cv::cvtColor(rgba(cv::Rect(0, 0, std::min(width, rgba.cols), std::min(height, rgba.rows))), grey,
               cv::COLOR_RGBA2GRAY);
  return cv::mean(grey)[0];
}

}  // namespace rumi::synth
