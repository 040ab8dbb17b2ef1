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
  std::string mask;                // name of the mask's file, as in the text; empty if it names no mask
  std::vector<std::string> notes;  // name the fields that are not used; to be logged once
};

// Reads and checks a calibration. `name` stands for the text in Errors, which name the field, its value and what to do.
Result<Calibration> parse_calibration(const std::string& text, const std::string& name);
// Reads a calibration whose text is already split into fields. An Error if a field is missing, unknown, of a wrong kind
// or not one of the camera's model. Does not judge the numbers otherwise: check_calibration() does that.
Result<Calibration> read_calibration(Fields in);
// An Error says why no image can be used with this camera.
Result<> check_calibration(const Camera& camera);

// Returns a text that parse_calibration() reads back without loss.
std::string camera_to_yaml(const Camera& camera);

}  // namespace rumi
