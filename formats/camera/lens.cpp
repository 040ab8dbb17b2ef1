// SPDX-License-Identifier: BSD-3-Clause
#include "formats/camera/lens.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

namespace rumi {

void set_intrinsics(const std::vector<double>& fx_fy_cx_cy, Camera* camera) {
  camera->fx = fx_fy_cx_cy[0];
  camera->fy = fx_fy_cx_cy[1];
  camera->cx = fx_fy_cx_cy[2];
  camera->cy = fx_fy_cx_cy[3];
}

void read_matrix(Fields& in, const std::string& key, Camera* camera) {
  const std::vector<double> k = in.list(key, "fx, 0, cx, 0, fy, cy, 0, 0, 1", 9);
  if (in.error()) return;
  const std::string field = in.full(key);
  const auto wrong = [&](const std::string& why) { in.fail(field + " " + why); };
  if (std::all_of(k.begin(), k.end(), [](double v) { return v == 0; }))
    return wrong("is all zero: whoever wrote it had no calibration; calibrate the camera");
  if (k[2] == 0 && k[5] == 0 && k[6] != 0 && k[7] != 0)
    return wrong("is written column by column (as MATLAB does): write it row by row, [fx, 0, cx, 0, fy, cy, 0, 0, 1]");
  if (k[3] != 0 || k[6] != 0 || k[7] != 0 || k[8] != 1)
    return wrong("is not of the form [fx, 0, cx, 0, fy, cy, 0, 0, 1] (row by row)");
  if (std::abs(k[1]) >= kLargestSkew_px)
    return wrong(
        fmt::format("has a skew of {:.6g} px (the second value): a camera with a skew is not supported; "
                    "calibrate again without one (OpenCV's calibrateCamera has none), or undistort the images "
                    "with this matrix and give the matrix of the new ones",
                    k[1]));
  if (k[1] != 0)
    in.note(fmt::format("the skew of {:.6g} px in {} is left out (it is below a tenth of a pixel)", k[1], field));
  set_intrinsics({k[0], k[4], k[2], k[5]}, camera);
}

void set_fisheye(Fields& in, const std::vector<double>& d, const std::string& field, Camera* camera) {
  camera->model = Camera::Model::kKannalaBrandt;
  if (d.size() != 4)
    return in.fail(fmt::format("{} has {} values: the equidistant model has 4 (k1 k2 k3 k4)", field, d.size()));
  camera->k1 = d[0], camera->k2 = d[1], camera->k3 = d[2], camera->k4 = d[3];
}

void set_radial_tangential(Fields& in, const std::vector<double>& d, const std::string& field, Camera* camera) {
  camera->model = Camera::Model::kPinhole;
  if (d.empty()) return;
  if (d.size() < 4) return in.fail(fmt::format("{} has {} values: must have 4 or 5 (k1 k2 p1 p2 k3)", field, d.size()));
  if (d.size() == 4 && lower_case(in.full(field)).find("fisheye") != std::string::npos)
    return in.fail(
        fmt::format("{} is of a fisheye, as its name says, and its format here of a lens that is none: write "
                    "the numbers as model: fisheye, fx, fy, cx, cy, k1, k2, k3, k4, width, height",
                    field));
  camera->k1 = d[0], camera->k2 = d[1], camera->p1 = d[2], camera->p2 = d[3];
  if (d.size() > 4) camera->k3 = d[4];
  for (size_t i = 5; i < d.size(); ++i) {
    if (d[i] == 0) continue;
    const std::string name = i < 8 ? fmt::format("k{}", i - 1) : "thin prism or tilt";
    return in.fail(
        fmt::format("{}[{}] ({}) is {:.6g}: the rational model is not supported; calibrate again with k1 k2 p1 p2 k3 "
                    "only (plumb_bob), or rectify the images and give the rectified camera",
                    field, i, name, d[i]));
  }
}

void refuse_model(Fields& in, const std::string& field, const std::string& value, const std::string& known) {
  in.fail(fmt::format("{} is '{}', and supported is only {}: calibrate with that, or rectify the images", field, value,
                      known));
}

std::string lower_case(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

}  // namespace rumi
