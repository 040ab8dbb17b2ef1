// SPDX-License-Identifier: BSD-3-Clause
// Hands a mesh and its textures to OpenGL, and how a camera looks at it. A context must be current.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "slam/geometry/camera.h"
#include "slam/geometry/transform.h"
#include "synth/mesh.h"

namespace rumi::synth {

// Returns the projection of an ideal pinhole camera.
Eigen::Matrix4d clip_from_camera(const Camera& camera, double near_m, double far_m);
// Returns the normals of the planes around what a camera sees. They point inwards, in the camera's frame.
std::vector<Eigen::Vector3d> frustum_normals(const Camera& camera);
// True if a part of the box may be within the planes with these normals.
bool is_in_frustum(const std::vector<Eigen::Vector3d>& normals, const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                   const SE3& cam_from_world);

// These return a buffer, which stays bound.
unsigned upload_vertices(const std::vector<Vertex>& vertices);
unsigned upload_indices(const std::vector<uint32_t>& indices);
// Fills the bound texture, an array of which each layer (CV_8UC2) is an atlas' one, and lets go of each layer that it
// has copied. wrap: GL_REPEAT and so on.
void upload_textures(std::vector<cv::Mat> layers, unsigned wrap);
// Says where an attribute lies within Vertex.
void attribute(unsigned location, int components, unsigned type, bool normalized, size_t offset);

}  // namespace rumi::synth
