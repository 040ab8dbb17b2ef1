// SPDX-License-Identifier: BSD-3-Clause
#include "bus/wire/calibration.h"
#include "formats/camera/formats.h"

namespace rumi {

Result<FileCameras> read_rumi(const Fields& in) {
  const Result<Calibration> own = read_calibration(in);
  if (!own) return FileCameras{"rumi", {{.name = "", .lens = "", .camera = own.error()}}};
  return FileCameras{"rumi", {{.name = "", .lens = "", .camera = own->camera, .notes = own->notes, .mask = own->mask}}};
}

FileCamera file_camera(const std::string& name, const Camera& camera, Fields& in) {
  if (!in.error()) in.tell_unused();
  return {name, name, in.error() ? Result<Camera>(*in.error()) : camera, in.notes()};
}

}  // namespace rumi
