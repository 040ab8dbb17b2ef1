// SPDX-License-Identifier: BSD-3-Clause
#include "synth/mesh_upload.h"

#include "viewer_offscreen/gl/gl.h"

namespace rumi::synth {

using namespace viewer_offscreen;  // OpenGL's functions

namespace {

constexpr int kMipLevels = 6;

unsigned upload(GLenum target, size_t bytes, const void* data) {
  GLuint buffer = 0;
  glGenBuffers(1, &buffer);
  glBindBuffer(target, buffer);
  glBufferData(target, static_cast<GLsizeiptr>(bytes), data, GL_STATIC_DRAW);
  return buffer;
}

}  // namespace

Eigen::Matrix4d clip_from_camera(const Camera& c, double near_m, double far_m) {
  // Positive clip y is downwards in the image, see OffscreenContext::read.
  Eigen::Matrix4d m = Eigen::Matrix4d::Zero();
  m(0, 0) = 2 * c.fx / c.width;
  m(0, 2) = 2 * (c.cx + 0.5) / c.width - 1;
  m(1, 1) = 2 * c.fy / c.height;
  m(1, 2) = 2 * (c.cy + 0.5) / c.height - 1;
  m(2, 2) = (far_m + near_m) / (far_m - near_m);
  m(2, 3) = -2 * far_m * near_m / (far_m - near_m);
  m(3, 2) = 1;
  return m;
}

std::vector<Eigen::Vector3d> frustum_normals(const Camera& c) {
  const double l = (-0.5 - c.cx) / c.fx, r = (c.width - 0.5 - c.cx) / c.fx;
  const double t = (-0.5 - c.cy) / c.fy, b = (c.height - 0.5 - c.cy) / c.fy;
  return {{1, 0, -l}, {-1, 0, r}, {0, 1, -t}, {0, -1, b}, {0, 0, 1}};
}

bool is_in_frustum(const std::vector<Eigen::Vector3d>& normals, const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                   const SE3& cam_from_world) {
  for (const Eigen::Vector3d& inward : normals) {
    const Eigen::Vector3d n = cam_from_world.rotation.conjugate() * inward;
    const Eigen::Vector3d farthest = (n.array() > 0).select(high, low);
    if (n.dot(farthest) + inward.dot(cam_from_world.translation) < 0) return false;
  }
  return true;
}

unsigned upload_vertices(const std::vector<Vertex>& vertices) {
  return upload(GL_ARRAY_BUFFER, vertices.size() * sizeof(Vertex), vertices.data());
}

unsigned upload_indices(const std::vector<uint32_t>& indices) {
  return upload(GL_ELEMENT_ARRAY_BUFFER, indices.size() * sizeof(uint32_t), indices.data());
}

void upload_textures(std::vector<cv::Mat> layers, unsigned wrap) {
  glTexImage3D(GL_TEXTURE_2D_ARRAY, 0, GL_RG8, TextureAtlas::kSize, TextureAtlas::kSize,
               static_cast<GLsizei>(layers.size()), 0, GL_RG, GL_UNSIGNED_BYTE, nullptr);
  for (size_t i = 0; i < layers.size(); ++i) {
    glTexSubImage3D(GL_TEXTURE_2D_ARRAY, 0, 0, 0, static_cast<GLint>(i), TextureAtlas::kSize, TextureAtlas::kSize, 1,
                    GL_RG, GL_UNSIGNED_BYTE, layers[i].data);
    layers[i].release();
  }
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAX_LEVEL, kMipLevels);
  glGenerateMipmap(GL_TEXTURE_2D_ARRAY);
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_WRAP_S, static_cast<GLint>(wrap));
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_WRAP_T, static_cast<GLint>(wrap));
}

void attribute(unsigned location, int components, unsigned type, bool normalized, size_t offset) {
  glEnableVertexAttribArray(location);
  glVertexAttribPointer(location, components, type, normalized ? GL_TRUE : GL_FALSE, sizeof(Vertex),
                        reinterpret_cast<const void*>(offset));
}

}  // namespace rumi::synth
