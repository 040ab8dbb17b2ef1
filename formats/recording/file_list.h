// SPDX-License-Identifier: BSD-3-Clause
// Reads recordings of one file per image: TUM-style (rgb.txt), EuRoC (data.csv), and plain folders.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "formats/image/image_file.h"
#include "formats/recording/frame_reader.h"

namespace rumi {

struct FileList {
  static constexpr int kWholeFile = -1;
  struct Entry {
    int64_t utime_us = 0;
    std::filesystem::path file;
    int line = 0;           // line in the list, from 1; 0 for a plain folder
    int page = kWholeFile;  // page of a TIFF file that has several
  };
  std::vector<Entry> entries;      // in the order of the list
  std::filesystem::path source;    // the list, or the folder
  Malformed malformed;             // lines that cannot be read; names without a time among those that have one
  int64_t not_read = 0;            // pictures of a kind that is not read, and pages behind a file's first one
  std::string why_no_times;        // empty, or why the times of all entries are 0
  std::vector<std::string> notes;  // tell the user how the recording was read
};

struct ListOptions {
  std::string files;        // pattern of the images that are wanted, see choose_images(); empty: those of one camera
  bool needs_times = true;  // false: times need not be readable, and a line may be a path alone
};

// Errors of these functions name the file, what is wrong, and what to do. A list that names no image is an Error, a
// folder without images is not.

// Reads rgb.txt: "seconds path" in each line, '#' comments; paths are relative to the folder of the list. If a line
// names two images ("seconds path seconds path" for colour and depth, or "seconds left right"), the first one that is
// no depth is taken.
Result<FileList> read_tum_list(const std::filesystem::path& rgb_txt, const ListOptions& options);
// Reads data.csv: "nanoseconds,name" in each line; the images are in the folder `data` beside it.
Result<FileList> read_euroc_list(const std::filesystem::path& data_csv, const ListOptions& options);
// Lists the images of one camera in a folder, in natural order (2 before 10), with the times that their names or a file
// beside them give, if any.
Result<FileList> list_image_folder(const std::filesystem::path& folder, const ListOptions& options);

// True for a folder with images that can be played.
bool has_images(const std::filesystem::path& folder);

// Lists the pages of a TIFF file, in their order. An Error if it has none.
Result<FileList> list_pages(const std::filesystem::path& tiff);

// `grey_range`: for images of 16 bits. If it is not given, the reader measures the range of the recording when it meets
// the first such image.
std::unique_ptr<FrameReader> make_file_list_reader(FileList list, std::optional<GreyRange> grey_range);

}  // namespace rumi
