// SPDX-License-Identifier: BSD-3-Clause
// Reads what `rs-enumerate-devices -c` prints: a block for each stream and size. For many people it is the only
// calibration.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <sstream>

#include "formats/camera/formats.h"
#include "formats/camera/lens.h"

namespace rumi {
namespace {

struct Block {
  std::string stream;
  std::map<std::string, std::string> values;
};

std::string trimmed(const std::string& text) {
  const size_t first = text.find_first_not_of(" \t\r");
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::vector<std::string> words_of(std::string text) {
  std::replace(text.begin(), text.end(), ',', ' ');
  std::istringstream in(text);
  return {std::istream_iterator<std::string>(in), {}};
}

// Reads blocks of "Intrinsic of "Color" / 640x480 / {...}", and the "Key: value" lines below.
std::vector<Block> blocks_of(const std::string& text) {
  constexpr size_t kMostBlocks = 500, kMostValues = 50;
  constexpr const char* kHead = "Intrinsic of \"";
  std::vector<Block> blocks;
  bool inside = false;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line) && blocks.size() < kMostBlocks;) {
    const size_t head = line.find(kHead), colon = line.find(':');
    const bool is_motion = line.find("Motion Intrinsic") != std::string::npos;
    if (head != std::string::npos && !is_motion) {
      const size_t begin = head + std::string(kHead).size();
      blocks.push_back({line.substr(begin, line.find('"', begin) - begin), {}});
      inside = true;
    } else if (trimmed(line).empty() || colon == std::string::npos) {
      inside = false;
    } else if (inside && blocks.back().values.size() < kMostValues) {
      blocks.back().values[trimmed(line.substr(0, colon))] = trimmed(line.substr(colon + 1));
    }
  }
  return blocks;
}

std::string yaml_of(const Block& block) {
  std::string yaml;
  for (const auto& [key, value] : block.values) {
    if (key == "Coeffs")
      yaml += fmt::format("Coeffs: [{}]\n", fmt::join(words_of(value), ", "));
    else if (value.find_first_of("'\n") == std::string::npos)
      yaml += fmt::format("'{}': '{}'\n", key, value);
  }
  return yaml;
}

void set_lens(Fields& in, Camera* camera) {
  const std::string model = lower_case(in.text("Distortion", "none"));
  const std::vector<double> d = in.has("Coeffs") ? in.list("Coeffs", "five numbers") : std::vector<double>();
  const bool is_none = std::all_of(d.begin(), d.end(), [](double value) { return value == 0; });
  if (model.starts_with("kannala"))
    return set_fisheye(in, {d.begin(), d.begin() + std::min<size_t>(d.size(), 4)}, "Coeffs", camera);
  if (is_none) return;
  // The modified model differs only if there is tangential distortion.
  const bool is_brown =
      model == "brown conrady" || (model == "modified brown conrady" && d.size() > 3 && d[2] == 0 && d[3] == 0);
  if (is_brown) return set_radial_tangential(in, d, "Coeffs", camera);
  in.fail(
      fmt::format("Distortion is {} with Coeffs that are not 0: supported are Brown Conrady, Kannala Brandt4 and any "
                  "with Coeffs of 0; calibrate the camera (rumi calibrate)",
                  in.quoted("Distortion")));
}

FileCamera read_block(const Block& block, const std::string& file) {
  const auto value = [&block](const char* key) {
    const auto found = block.values.find(key);
    return found == block.values.end() ? std::string("?") : found->second;
  };
  const std::string name = fmt::format("{} {}x{}", block.stream, value("Width"), value("Height"));
  Fields in(load_yaml(yaml_of(block)), fmt::format("{}, Intrinsic of \"{}\"", file, block.stream));
  Camera camera;
  camera.width = in.size("Width"), camera.height = in.size("Height");
  camera.fx = in.number("Fx", "pixels"), camera.fy = in.number("Fy", "pixels");
  camera.cx = in.number("PPX", "pixels"), camera.cy = in.number("PPY", "pixels");
  if (!in.error()) set_lens(in, &camera);
  FileCamera read = file_camera(name, camera, in);
  read.lens = block.stream;
  read.notes.clear();  // they only name the field of view, the rest of a block
  return read;
}

int rank(const std::string& stream) {
  const std::string name = lower_case(stream);
  return name.starts_with("color") || name.starts_with("rgb") ? 0 : name.starts_with("depth") ? 2 : 1;
}

}  // namespace

bool is_realsense_listing(const std::string& text) {
  return text.find("Intrinsic of \"") != std::string::npos ||
         (text.find("Device info:") != std::string::npos && text.find("RealSense") != std::string::npos);
}

Result<FileCameras> read_realsense(const std::string& text, const std::string& file) {
  FileCameras all{"RealSense", {}};
  Error unreadable{"is a listing of RealSense cameras without their calibration: make it with rs-enumerate-devices -c",
                   file};
  for (const Block& block : blocks_of(text)) {
    try {
      FileCamera camera = read_block(block, file);
      const bool is_new = std::none_of(all.cameras.begin(), all.cameras.end(),
                                       [&camera](const FileCamera& other) { return other.name == camera.name; });
      if (is_new) all.cameras.push_back(std::move(camera));
    } catch (const YAML::Exception& e) {
      unreadable = {fmt::format("cannot be read ({})", e.what()),
                    fmt::format("{}, Intrinsic of \"{}\"", file, block.stream)};
    }
  }
  std::stable_sort(all.cameras.begin(), all.cameras.end(),
                   [](const FileCamera& a, const FileCamera& b) { return rank(a.lens) < rank(b.lens); });
  if (all.cameras.empty()) return unreadable;
  return all;
}

}  // namespace rumi
