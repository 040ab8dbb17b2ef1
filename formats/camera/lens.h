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
// Reads a camera matrix row by row: fx 0 cx 0 fy cy 0 0 1. A skew below kLargestSkew_px is left out, with a note.
void read_matrix(Fields& in, const std::string& key, Camera* camera);
// Sets the equidistant model, with the coefficients k1 k2 k3 k4.
void set_fisheye(Fields& in, const std::vector<double>& d, const std::string& field, Camera* camera);
// Sets the radial-tangential model, with the coefficients in OpenCV's order: k1 k2 p1 p2 [k3 [k4 k5 k6 [...]]]. Those
// behind k3 must be zero, because Camera has no model for them.
void set_radial_tangential(Fields& in, const std::vector<double>& d, const std::string& field, Camera* camera);
void refuse_model(Fields& in, const std::string& field, const std::string& value, const std::string& known);

std::string lower_case(std::string text);

}  // namespace rumi
