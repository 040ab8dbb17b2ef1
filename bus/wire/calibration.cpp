// SPDX-License-Identifier: BSD-3-Clause
#include "bus/wire/calibration.h"

#include <fmt/format.h>

#include <set>

#include "bus/wire/image_fold.h"

namespace rumi {

Result<Calibration> read_calibration(Fields in) {
  static const std::set<std::string> kKeys = {"model", "fx", "fy", "cx",    "cy",     "k1",  "k2",  "p1",
                                              "p2",    "k3", "k4", "width", "height", "fps", "mask"};
  Camera camera;
  std::string mask;
  // A misspelt coefficient would silently count as zero.
  for (const std::string& name : in.names()) {
    if (kKeys.contains(name)) continue;
    in.fail(fmt::format("'{}' is not known: the keys are model fx fy cx cy k1 k2 p1 p2 k3 (k4) width height fps mask",
                        name.substr(0, 40)));
    return *in.error();
  }
  const std::string model = in.text("model", "pinhole");
  const bool fisheye = model == "kannala_brandt" || model == "fisheye";
  if (!fisheye && model != "pinhole") {
    in.fail(fmt::format(
        "model is '{}', and supported is only pinhole and kannala_brandt (or fisheye): calibrate with that, or "
        "rectify the images",
        model));
    return *in.error();
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
  if (!in.error()) in.tell_unused();
  if (in.error()) return *in.error();
  return Calibration{camera, mask, in.notes()};
}

Result<> check_calibration(const Camera& camera) {
  if (const std::string wrong = camera.check(); !wrong.empty()) return Error{wrong, "", "correct it there"};
  if (!(camera.fps >= 0 && camera.fps <= 1e5))
    return Error{fmt::format("fps is {:.6g}: must be 0 (unknown) to 100000 images per second", camera.fps)};
  if (const Fold fold = fold_of(camera); fold.is_too_much) return Error{fold.text};
  return {};
}

Result<Calibration> parse_calibration(const std::string& text, const std::string& name) {
  const Result<Fields> fields = fields_of_text(text, name, "expected our YAML (fx: 525 ... width: 640)");
  if (!fields) return fields.error();
  Result<Calibration> result = read_calibration(*fields);
  if (!result) return result;
  if (const Result<> checked = check_calibration(result->camera); !checked) return Error{checked.error_text(), name};
  return result;
}

std::string camera_to_yaml(const Camera& camera) {
  const bool fisheye = camera.model == Camera::Model::kKannalaBrandt;
  std::string out = fmt::format("model: {}\n", fisheye ? "kannala_brandt" : "pinhole");
  const auto add = [&out](const char* key, double value) { out += fmt::format("{}: {:.17g}\n", key, value); };
  add("fx", camera.fx);
  add("fy", camera.fy);
  add("cx", camera.cx);
  add("cy", camera.cy);
  add("k1", camera.k1);
  add("k2", camera.k2);
  if (!fisheye) add("p1", camera.p1);
  if (!fisheye) add("p2", camera.p2);
  add("k3", camera.k3);
  if (fisheye) add("k4", camera.k4);
  out += fmt::format("width: {}\nheight: {}\n", camera.width, camera.height);
  add("fps", camera.fps);
  return out;
}

}  // namespace rumi
