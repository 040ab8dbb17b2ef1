// SPDX-License-Identifier: BSD-3-Clause
#include "synth/rasterizer.h"

#include <array>
#include <cstddef>

#include "synth/mesh_upload.h"
#include "viewer_offscreen/gl/gl.h"

namespace rumi::synth {

using namespace viewer_offscreen;  // OpenGL's functions

namespace {

constexpr double kNear_m = 0.05, kFar_m = 80;

const char* const kVertexShader = R"(#version 330 core
uniform mat4 clip_from_room;
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 uv_layer;
layout(location = 2) in float light;
layout(location = 3) in vec3 dark;
layout(location = 4) in vec3 bright;
layout(location = 5) in vec3 accent;
out vec3 f_uv;
out float f_light;
flat out vec3 f_dark, f_bright, f_accent;
void main() {
  gl_Position = clip_from_room * vec4(position, 1.0);
  f_uv = uv_layer;
  f_light = light;
  f_dark = dark;
  f_bright = bright;
  f_accent = accent;
})";

const char* const kFragmentShader = R"(#version 330 core
uniform sampler2DArray atlas;
uniform float blankness;
in vec3 f_uv;
in float f_light;
flat in vec3 f_dark, f_bright, f_accent;
out vec4 colour;
void main() {
  vec2 t = texture(atlas, f_uv).rg;
  vec3 paint = mix(mix(f_dark, f_bright, t.r), f_accent, t.g * 0.85);
  colour = vec4(mix(paint * f_light * 0.78, vec3(0.42), blankness), 1.0);
})";

}  // namespace

Rasterizer::Rasterizer(Mesh mesh, const Camera& pinhole)
    : context_(pinhole.width, pinhole.height, 4), camera_(pinhole), parts_(std::move(mesh.parts)) {
  program_ = viewer_offscreen::compile_program(kVertexShader, kFragmentShader);
  glGenVertexArrays(1, &vertex_array_);
  glBindVertexArray(vertex_array_);
  vertex_buffer_ = upload_vertices(mesh.vertices);
  index_buffer_ = upload_indices(mesh.indices);
  attribute(0, 3, GL_FLOAT, false, offsetof(Vertex, position));
  attribute(1, 3, GL_FLOAT, false, offsetof(Vertex, uv));
  attribute(2, 1, GL_FLOAT, false, offsetof(Vertex, light));
  attribute(3, 3, GL_UNSIGNED_BYTE, true, offsetof(Vertex, dark));
  attribute(4, 3, GL_UNSIGNED_BYTE, true, offsetof(Vertex, bright));
  attribute(5, 3, GL_UNSIGNED_BYTE, true, offsetof(Vertex, accent));
  glGenTextures(1, &texture_);
  glBindTexture(GL_TEXTURE_2D_ARRAY, texture_);
  upload_textures(mesh.atlas.layers(), GL_CLAMP_TO_EDGE);
  frustum_ = frustum_normals(camera_);
}

Rasterizer::~Rasterizer() = default;  // the context destroys all objects of OpenGL

void Rasterizer::draw(const SE3& cam_from_room, double blankness, cv::Mat* rgba) {
  context_.make_current();
  glClearColor(0.1f, 0.1f, 0.1f, 1);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glEnable(GL_DEPTH_TEST);
  // Front faces are clockwise, but the image is drawn upside down.
  glEnable(GL_CULL_FACE);
  glFrontFace(GL_CCW);
  glUseProgram(program_);
  Eigen::Matrix4d view = Eigen::Matrix4d::Identity();
  view.topLeftCorner<3, 3>() = cam_from_room.rotation.toRotationMatrix();
  view.topRightCorner<3, 1>() = cam_from_room.translation;
  const Eigen::Matrix4f clip = (clip_from_camera(camera_, kNear_m, kFar_m) * view).cast<float>();
  glUniformMatrix4fv(glGetUniformLocation(program_, "clip_from_room"), 1, GL_FALSE, clip.data());
  glUniform1f(glGetUniformLocation(program_, "blankness"), static_cast<float>(blankness));
  std::vector<GLsizei> counts;
  std::vector<const void*> offsets;
  for (const Part& part : parts_) {
    if (part.indices == 0 || !is_in_frustum(frustum_, part.low, part.high, cam_from_room)) continue;
    counts.push_back(static_cast<GLsizei>(part.indices));
    offsets.push_back(reinterpret_cast<const void*>(static_cast<size_t>(part.first_index) * sizeof(uint32_t)));
  }
  glMultiDrawElements(GL_TRIANGLES, counts.data(), GL_UNSIGNED_INT, offsets.data(),
                      static_cast<GLsizei>(counts.size()));
  context_.read(rgba);
}

}  // namespace rumi::synth
