// SPDX-License-Identifier: BSD-3-Clause
// Makes small recordings for the tests.
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.h"

namespace rumi::testing {

namespace fs = std::filesystem;

// Returns a picture that differs for every `number`, with enough structure that damage to its JPEG shows.
inline cv::Mat picture(int number, int width = 64, int height = 48, bool colour = false) {
  cv::Mat out(height, width, colour ? CV_8UC3 : CV_8UC1);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width * out.channels(); ++x)
      out.ptr(y)[x] = static_cast<uint8_t>((x * 7 + y * 13 + number * 29) ^ (x * y));
  return out;
}

inline constexpr const char* kCalibration = "fx: 50\nfy: 51\ncx: 32\ncy: 24\nk1: 0.1\nwidth: 64\nheight: 48\nfps: 10\n";

// Writes a TUM-style folder with n images 0.1 s apart, from 1000 s on.
inline void write_tum(const fs::path& folder, int n, const std::string& extension = ".png") {
  std::string list = "# seconds file\n";
  for (int i = 0; i < n; ++i) {
    const std::string name = fmt::format("rgb/{}{}", i, extension);
    fs::create_directories(folder / "rgb");
    cv::imwrite((folder / name).string(), picture(i));
    list += fmt::format("{}.{}00000 {}\n", 1000 + i / 10, i % 10, name);
  }
  write_file(folder / "rgb.txt", list);
  write_file(folder / "calibration.yaml", kCalibration);
}

}  // namespace rumi::testing
