// SPDX-License-Identifier: BSD-3-Clause
// A model as COLMAP writes it. The input is cameras.bin, images.bin and points3D.bin, each preceded by its length.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "fuzz/good_messages.h"
#include "fuzz/scratch.h"
#include "ruminator/colmap/write_model.h"

namespace rumi::fuzz {
namespace {

using namespace ruminator;

constexpr const char* kFiles[] = {"cameras.bin", "images.bin", "points3D.bin"};
const std::vector<int> kKeypoints = {3, 3, 4};  // number per image; a track must not refer to any other

void run(View input) {
  std::filesystem::create_directory(scratch() / "model");
  for (const char* name : kFiles) {
    const size_t given = input.size() < 2 ? 0 : input[0] | input[1] << 8;
    input = input.subspan(std::min<size_t>(2, input.size()));
    const size_t length = std::min(given, input.size());
    scratch().write(std::string("model/") + name, input.first(length));
    input = input.subspan(length);
  }
  const Result<SparseModel> model = read_colmap_model(scratch() / "model", kKeypoints);
  if (!model) return;
  for (const SparseModel::Point& point : model->points)
    for (const auto& [image, keypoint] : point.track)
      if (keypoint < 0 || keypoint >= kKeypoints.at(static_cast<size_t>(image)))
        throw std::logic_error("a keypoint that is not there has got through");
}

Bytes contents(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return to_bytes(text.str());
}

std::vector<Bytes> seeds() {
  SparseModel model;
  model.fx = model.fy = 50;
  std::vector<WindowImage> images(kKeypoints.size());
  for (size_t i = 0; i < images.size(); ++i) {
    images[i].name = std::to_string(i) + ".jpg";
    images[i].keypoints.assign(static_cast<size_t>(kKeypoints[i]), Eigen::Vector2f(1, 2));
    model.cam_from_world[static_cast<int>(i)] = SE3();
  }
  for (int k = 0; k < 3; ++k) model.points.push_back({{1.0 * k, 0, 3}, {{0, k}, {1, k}, {2, k}}});
  const std::string folder = scratch() / "seed";
  std::filesystem::create_directory(folder);
  if (!write_colmap_model(folder, good_camera(), images, model)) return {{}};
  Bytes seed;
  for (const char* name : kFiles) {
    const Bytes bytes = contents(folder + "/" + name);
    seed.insert(seed.end(), {static_cast<uint8_t>(bytes.size()), static_cast<uint8_t>(bytes.size() >> 8)});
    seed.insert(seed.end(), bytes.begin(), bytes.end());
  }
  return {seed};
}

const Registered registered({"colmap_model", run, seeds});

}  // namespace
}  // namespace rumi::fuzz
