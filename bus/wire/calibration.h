// SPDX-License-Identifier: BSD-3-Clause
// The calibration that travels with images, submaps and windows: our own flat YAML (docs/calibration.md). The files of
// other tools are read by formats/camera.
#pragma once

#include <string>
#include <vector>

#include "bus/wire/yaml_fields.h"
#include "slam/geometry/camera.h"

namespace rumi {

struct Calibration {
  Camera camera;
  std::string mask;                // the file that it names; empty if it names none
  std::vector<std::string> notes;  // its fields that are not used, to be logged once
  std::string error;               // empty, or the name, field, value and what to do
  bool ok() const { return error.empty(); }
};

// `name` stands for the text in errors.
Calibration parse_calibration(const std::string& text, const std::string& name);
// The same text, already split into fields. Numbers are not judged: check_calibration() does that.
Calibration read_calibration(Fields in);
// Why no image can be used with this camera; empty if it can.
std::string check_calibration(const Camera& camera);

// What parse_calibration() reads back without loss.
std::string camera_to_yaml(const Camera& camera);

}  // namespace rumi
