// SPDX-License-Identifier: BSD-3-Clause
// render_boards FOLDER pinhole|fisheye WIDTH HEIGHT COUNT [BOARD]: writes images of a board by a known camera, to try
// `rumi calibrate` by hand and to measure it. The camera is in FOLDER/truth.yaml.
#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "bus/wire/calibration.h"
#include "tests/rumi/calibration/board_scene.h"

int main(int argc, char** argv) {
  using namespace rumi;
  using namespace rumi::tool;
  const Result<Board> board = argc > 6 ? parse_board(argv[6]) : Board();
  if (argc < 6 || !board) {
    fmt::print(stderr, "render_boards FOLDER pinhole|fisheye WIDTH HEIGHT COUNT [BOARD]\n");
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  const bool fisheye = std::string(argv[2]) == "fisheye";
  const int width = std::atoi(argv[3]), height = std::atoi(argv[4]), count = std::atoi(argv[5]);
  std::filesystem::create_directories(folder);
  const Camera camera = fisheye ? testing::fisheye_camera(width, height) : testing::pinhole_camera(width, height);
  std::ofstream(folder / "truth.yaml") << camera_to_yaml(camera);
  const testing::BoardScene scene(*board, camera);
  int number = 0;
  for (const testing::BoardPose& pose : scene.varied_poses(count, fisheye ? 90 : 45)) {
    cv::imwrite((folder / fmt::format("board{:03}.png", number)).string(), scene.render(pose, {}, number));
    ++number;
  }
  return 0;
}
