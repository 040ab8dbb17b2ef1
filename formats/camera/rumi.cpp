// SPDX-License-Identifier: BSD-3-Clause
#include "bus/wire/calibration.h"
#include "formats/camera/formats.h"

namespace rumi {

FileCameras read_rumi(const Fields& in) {
  const Calibration own = read_calibration(in);
  return {"rumi",
          {{.name = "", .lens = "", .camera = own.camera, .error = own.error, .notes = own.notes, .mask = own.mask}},
          ""};
}

FileCamera file_camera(const std::string& name, const Camera& camera, Fields& in) {
  if (in.error().empty()) in.tell_unused();
  return {name, name, camera, in.error(), in.notes()};
}

}  // namespace rumi
