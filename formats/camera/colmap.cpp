// SPDX-License-Identifier: BSD-3-Clause
// Reads COLMAP's cameras.txt: CAMERA_ID MODEL WIDTH HEIGHT PARAMS... in each line.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <charconv>
#include <map>
#include <sstream>

#include "formats/camera/formats.h"
#include "formats/camera/lens.h"

namespace rumi {
namespace {

constexpr size_t kMostLines = 1000;

// Returns the parameters of each model, in their order in the line.
const std::map<std::string, std::vector<std::string>>& parameters() {
  static const std::map<std::string, std::vector<std::string>> kParameters = {
      {"SIMPLE_PINHOLE", {"f", "cx", "cy"}},
      {"PINHOLE", {"fx", "fy", "cx", "cy"}},
      {"SIMPLE_RADIAL", {"f", "cx", "cy", "k1"}},
      {"RADIAL", {"f", "cx", "cy", "k1", "k2"}},
      {"OPENCV", {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2"}},
      {"FULL_OPENCV", {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"}},
      {"OPENCV_FISHEYE", {"fx", "fy", "cx", "cy", "k1", "k2", "k3", "k4"}},
      {"SIMPLE_RADIAL_FISHEYE", {"f", "cx", "cy", "k1"}},
      {"RADIAL_FISHEYE", {"f", "cx", "cy", "k1", "k2"}},
  };
  return kParameters;
}

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream in(line);
  std::vector<std::string> words;
  for (std::string word; words.size() < 32 && in >> word;) words.push_back(word);
  return words;
}

bool is_camera_line(const std::vector<std::string>& words) {
  const auto is_number = [](const std::string& word) {
    return word.find_first_not_of("0123456789") == std::string::npos;
  };
  return words.size() > 4 && is_number(words[0]) && is_number(words[2]) && is_number(words[3]) &&
         words[1].find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ_") == std::string::npos;
}

FileCamera read_line(const std::vector<std::string>& words, const std::string& file) {
  const std::string &name = words[0], &model = words[1];
  std::string yaml = fmt::format("width: '{}'\nheight: '{}'\n", words[2], words[3]);
  const auto known = parameters().find(model);
  for (size_t i = 4; known != parameters().end() && i < std::min(words.size(), 4 + known->second.size()); ++i)
    if (words[i].find('\'') == std::string::npos) yaml += fmt::format("{}: '{}'\n", known->second[i - 4], words[i]);
  Fields in(load_yaml(yaml), fmt::format("{}, camera {}", file, name));
  Camera camera;
  if (known == parameters().end()) {
    refuse_model(in, "its model", model, "PINHOLE, RADIAL, OPENCV, OPENCV_FISHEYE and their simple forms");
  } else if (words.size() != 4 + known->second.size()) {
    in.fail(fmt::format("{} has {} parameters ({}), and here are {}", model, known->second.size(),
                        fmt::join(known->second, " "), words.size() - 4));
  } else {
    camera.width = in.size("width"), camera.height = in.size("height");
    camera.fx = in.number(in.spelling({"fx", "f"}), "pixels"),
    camera.fy = in.number(in.spelling({"fy", "f"}), "pixels");
    // COLMAP counts from the corner of the first pixel, Rumi from its centre.
    camera.cx = in.number("cx", "pixels") - 0.5, camera.cy = in.number("cy", "pixels") - 0.5;
    std::vector<double> d;
    const bool fisheye = model.ends_with("FISHEYE");
    for (const char* key : {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"})
      if (!fisheye || *key == 'k') d.push_back(in.optional_number(key));
    if (fisheye) d.resize(4);
    fisheye ? set_fisheye(in, d, "its model", &camera) : set_radial_tangential(in, d, "its coefficients", &camera);
  }
  return file_camera(name, camera, in);
}

}  // namespace

bool is_colmap_list(const std::string& text) {
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    const std::vector<std::string> words = words_of(line);
    if (!words.empty() && words[0][0] != '#') return is_camera_line(words);
  }
  return false;
}

Result<FileCameras> read_colmap(const std::string& text, const std::string& file) {
  FileCameras all{"COLMAP", {}};
  std::istringstream in(text);
  for (std::string line; std::getline(in, line) && all.cameras.size() < kMostLines;)
    if (const std::vector<std::string> words = words_of(line); is_camera_line(words))
      all.cameras.push_back(read_line(words, file));
  if (all.cameras.size() == 1) all.cameras[0].name = all.cameras[0].lens = "";
  return all;
}

}  // namespace rumi
