// SPDX-License-Identifier: BSD-3-Clause
#include "formats/camera/given_camera.h"

#include <stdexcept>

#include "formats/camera/camera_file.h"

namespace rumi {

std::optional<Camera> read_given_camera(const std::string& file) {
  if (file.empty()) return std::nullopt;
  const Result<CameraFile> read = read_camera_file(file);
  if (!read) throw std::runtime_error(read.error_text());
  log_notes(*read);
  return read->camera;
}

}  // namespace rumi
