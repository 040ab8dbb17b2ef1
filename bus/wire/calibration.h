// SPDX-License-Identifier: BSD-3-Clause
// The calibration that travels with images, submaps and windows: our own flat YAML (docs/calibration.md). The files of
// other tools are read by formats/camera.
#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "bus/wire/yaml_fields.h"
#include "slam/geometry/camera.h"

namespace rumi {

struct Calibration {
  Camera camera;
  std::string mask;                // the file that it names; empty if it names none
  std::vector<std::string> notes;  // what a user should know about it
};

// `name` stands for the text in Errors, which name the field, its value and what to do.
Result<Calibration> parse_calibration(const std::string& text, const std::string& name);
// Reads a text that is already split into fields. Does not judge the numbers: check_calibration() does that.
Result<Calibration> read_calibration(Fields in);
// An Error says why no image can be used with this camera.
Result<> check_calibration(const Camera& camera);

// parse_calibration() reads this text back without loss.
std::string camera_to_yaml(const Camera& camera);

}  // namespace rumi
