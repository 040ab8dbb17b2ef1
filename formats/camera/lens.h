// SPDX-License-Identifier: BSD-3-Clause
// Shared by the formats: makes a Camera from a camera matrix and the coefficients of a lens, or refuses them.
#pragma once

#include <string>
#include <vector>

#include "bus/wire/yaml_fields.h"
#include "slam/geometry/camera.h"

namespace rumi {

// A smaller skew moves pixels by less than the uncertainty of keypoints.
inline constexpr double kLargestSkew_px = 0.1;

void set_intrinsics(const std::vector<double>& fx_fy_cx_cy, Camera* camera);
// Row by row, fx 0 cx 0 fy cy 0 0 1. A small skew is left out, and told.
void read_matrix(Fields& in, const std::string& key, Camera* camera);
// Equidistant, k1 k2 k3 k4.
void set_fisheye(Fields& in, const std::vector<double>& d, const std::string& field, Camera* camera);
// OpenCV's order: k1 k2 p1 p2 [k3 [k4 k5 k6 [...]]]. What Camera has no model for must be zero.
void set_radial_tangential(Fields& in, const std::vector<double>& d, const std::string& field, Camera* camera);
void refuse_model(Fields& in, const std::string& field, const std::string& value, const std::string& known);

std::string lower_case(std::string text);

}  // namespace rumi
