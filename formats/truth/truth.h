// SPDX-License-Identifier: BSD-3-Clause
// The true path, as datasets and tracking systems write it: TUM's lines, EuRoC's and TUM-VI's data.csv, KITTI's
// matrices, positions only, with any separator and unit of time. What was decided, or left out, is told in notes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "formats/truth/trajectory.h"

namespace rumi {

// The times of the recording's images.
struct RunTimes {
  int64_t first_us = 0, last_us = 0;
  int64_t period_us = 0;  // the usual one
};

struct TruthOptions {
  // The first column counts images at this rate instead of giving times (ICL-NUIM's *.gt.freiburg), or there are no
  // times (KITTI); 0 = there are.
  double frames_per_second = 0;
  // Helps to tell units of time, and numbers of images from times.
  std::optional<RunTimes> run = {};
  // Added to all times by evaluate_folder(), s. Nothing: that of find_truth_shift(), if there is one.
  std::optional<double> shift_s = 0;
};

struct TruthFile {
  std::vector<TimedPose> poses;    // by time, one per time; rotations are the identity without has_rotations
  bool has_rotations = true;       // rotations of the camera are known
  std::vector<std::string> notes;  // with the file's name
  std::string hint;                // what may be wrong if its times are not those of the images; may be empty
  std::string error;               // empty, or why the file could not be used
  bool ok() const { return error.empty(); }
};

// ICL-NUIM's files of poses have this ending. Their world is the renderer's, whose y points up: poses are mirrored, so
// that y points down as in the images.
inline constexpr const char* kEndingOfIclNuim = ".gt.freiburg";

TruthFile read_groundtruth(const std::string& file, const TruthOptions& options = {});

}  // namespace rumi
