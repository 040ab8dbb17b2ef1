// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <set>

#include "bus/wire/camera_file/formats.h"
#include "bus/wire/camera_file/lens.h"

namespace rumi {

FileCamera file_camera(const std::string& name, const Camera& camera, Fields& in) {
  if (in.error().empty()) in.tell_unused();
  return {name, name, camera, in.error(), in.notes()};
}

FileCameras read_rumi(Fields in) {
  static const std::set<std::string> kKeys = {"model", "fx", "fy", "cx",    "cy",     "k1",  "k2",  "p1",
                                              "p2",    "k3", "k4", "width", "height", "fps", "mask"};
  Camera camera;
  std::string mask;
  const auto done = [&] {
    FileCameras file{"rumi", {file_camera("", camera, in)}, ""};
    file.cameras[0].mask = mask;
    return file;
  };
  // A misspelt coefficient would silently count as zero.
  for (const std::string& name : in.names()) {
    if (kKeys.contains(name)) continue;
    in.fail(fmt::format("'{}' is not known: the keys are model fx fy cx cy k1 k2 p1 p2 k3 (k4) width height fps mask",
                        name.substr(0, 40)));
    return done();
  }
  const std::string model = in.text("model", "pinhole");
  const bool fisheye = model == "kannala_brandt" || model == "fisheye";
  if (!fisheye && model != "pinhole") {
    refuse_model(in, "model", model, "pinhole and kannala_brandt (or fisheye)");
    return done();
  }
  camera.model = fisheye ? Camera::Model::kKannalaBrandt : Camera::Model::kPinhole;
  camera.width = in.size("width");
  camera.height = in.size("height");
  const std::pair<const char*, double*> required[] = {
      {"fx", &camera.fx}, {"fy", &camera.fy}, {"cx", &camera.cx}, {"cy", &camera.cy}};
  for (const auto& [key, value] : required) *value = in.number(key, "pixels");
  const std::pair<const char*, double*> others[] = {{"k1", &camera.k1},  {"k2", &camera.k2}, {"p1", &camera.p1},
                                                    {"p2", &camera.p2},  {"k3", &camera.k3}, {"k4", &camera.k4},
                                                    {"fps", &camera.fps}};
  for (const auto& [key, value] : others) *value = in.optional_number(key);
  mask = in.text("mask", "");
  if (in.has("mask") && mask.empty())
    in.fail(fmt::format("mask is {}: must be the name of a PNG file, relative to this one", in.quoted("mask")));
  if (!fisheye && camera.k4 != 0)
    in.fail(fmt::format("k4 is {:.6g}, and only the model kannala_brandt has one: correct the model, or remove k4",
                        camera.k4));
  if (fisheye && (camera.p1 != 0 || camera.p2 != 0)) in.fail("p1 or p2 is not 0: model kannala_brandt has k1 k2 k3 k4");
  return done();
}

}  // namespace rumi
