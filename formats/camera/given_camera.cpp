// SPDX-License-Identifier: BSD-3-Clause
#include "formats/camera/given_camera.h"

#include "base/or_throw.h"
#include "formats/camera/camera_file.h"

namespace rumi {

std::optional<Camera> read_given_camera(const std::string& file) {
  if (file.empty()) return std::nullopt;
  const CameraFile read = or_throw(read_camera_file(file));
  log_notes(read);
  return read.camera;
}

}  // namespace rumi
