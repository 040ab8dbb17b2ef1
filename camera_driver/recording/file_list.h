// SPDX-License-Identifier: BSD-3-Clause
// Recordings of one file per image: TUM-style (rgb.txt), EuRoC (data.csv), and plain folders.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "camera_driver/recording/frame_reader.h"

namespace rumi::camera_driver {

struct FileList {
  struct Entry {
    int64_t utime_us = 0;
    std::filesystem::path file;
    int line = 0;  // in the list, 0 for a plain folder
  };
  std::vector<Entry> entries;    // in the order of the list
  std::filesystem::path source;  // the list, or the folder
  Malformed malformed;           // lines
  std::string error;             // empty, or file, what is wrong, and what to do
};

// rgb.txt: "seconds path" in each line, '#' comments; paths are relative to the folder of the list.
FileList read_tum_list(const std::filesystem::path& rgb_txt);
// data.csv: "nanoseconds,name" in each line; the images are in the folder `data` beside it.
FileList read_euroc_list(const std::filesystem::path& data_csv);
// All images of a folder in natural order (2 before 10). If all names are seconds (with decimals) or nanoseconds they
// are the times; else image i has the time i / rate_hz. rate_hz 0: not known, an error where it is needed.
FileList list_image_folder(const std::filesystem::path& folder, double rate_hz);

std::unique_ptr<FrameReader> make_file_list_reader(FileList list);

}  // namespace rumi::camera_driver
