// SPDX-License-Identifier: BSD-3-Clause
// Recognizes camera.txt of DSO and LSD-SLAM, with three lines: [MODEL] fx fy cx cy ...; width height; crop; and then
// the output's width height.
#include <fmt/format.h>

#include <cctype>
#include <map>
#include <sstream>
#include <vector>

#include "formats/camera/formats.h"

namespace rumi {
namespace {

// Returns our fields for the coefficients that follow cy; empty for a model that is not supported here.
std::string coefficients(const std::string& model, const std::vector<double>& d) {
  static const std::map<std::string, std::vector<const char*>> kNames = {{"RadTan", {"k1", "k2", "p1", "p2"}},
                                                                         {"EquiDistant", {"k1", "k2", "k3", "k4"}},
                                                                         {"KannalaBrandt", {"k1", "k2", "k3", "k4"}}};
  const auto names = kNames.find(model);
  std::string text = model == "RadTan" ? "" : "model: fisheye, ";
  if (names == kNames.end() || d.size() < 4) return "";
  for (size_t i = 0; i < 4; ++i) text += fmt::format("{}: {:.7g}, ", names->second[i], d[i]);
  return text;
}

}  // namespace

std::string known_dso(const std::string& text) {
  std::istringstream in(text);
  std::string first, model;
  double k[4] = {};
  int width = 0, height = 0;
  std::getline(in, first);
  std::istringstream line(first);
  if (!(line >> std::ws) || (std::isalpha(line.peek()) != 0 && !(line >> model))) return "";
  for (double& value : k)
    if (!(line >> value)) return "";
  std::vector<double> d;
  for (double value = 0; d.size() < 4 && line >> value;) d.push_back(value);
  if (d.empty() || !(in >> width >> height) || width <= 0 || height <= 0) return "";
  if (model.empty() || model == "Pinhole") model = d[0] == 0 ? "Pinhole" : "FOV";
  // Values below 1 are fractions of the size, counted from the corner of the first pixel.
  const bool is_relative = k[2] < 1 && k[3] < 1;
  const double across = is_relative ? width : 1, down = is_relative ? height : 1, corner = is_relative ? 0.5 : 0;
  const std::string lens = coefficients(model, d);
  if (lens.empty() && model != "Pinhole")
    return fmt::format(
        "is a camera.txt of DSO with its model {}, which is not had here: calibrate with plumb_bob (k1 k2 p1 p2 k3) or "
        "as a fisheye, or let DSO write rectified images and give their camera",
        model);
  return fmt::format(
      "is a camera.txt of DSO, which is not read: write fx: {:.7g}, fy: {:.7g}, cx: {:.7g}, cy: {:.7g}, {}width: {}, "
      "height: {}",
      k[0] * across, k[1] * down, k[2] * across - corner, k[3] * down - corner, lens, width, height);
}

}  // namespace rumi
