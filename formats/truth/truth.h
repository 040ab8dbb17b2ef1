// SPDX-License-Identifier: BSD-3-Clause
// Reads the true path, as datasets and tracking systems write it: TUM's lines, EuRoC's and TUM-VI's data.csv, KITTI's
// matrices, positions only, with any separator and unit of time. The notes say what was decided or left out.
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
  int64_t period_us = 0;  // usual time from image to image
};

struct TruthOptions {
  // The rate of the images, if the first column counts them instead of giving times (ICL-NUIM's *.gt.freiburg), or if
  // there are no times (KITTI). 0: the file has times.
  double frames_per_second = 0;
  // Helps to find the unit of times, and to tell times from numbers of images.
  std::optional<RunTimes> run = {};
  // Seconds that evaluate_folder() adds to all times. nullopt: the shift that find_truth_shift() finds, if any.
  std::optional<double> shift_s = 0;
};

struct TruthFile {
  std::vector<TimedPose> poses;    // in order of time, one per time; rotations are the identity unless has_rotations
  bool has_rotations = true;       // rotations of the camera are known
  std::vector<std::string> notes;  // each with the file's name
  std::string hint;                // what may be wrong if its times are not those of the images; may be empty
  std::string error;               // why the file could not be used; else empty
  bool ok() const { return error.empty(); }
};

// ICL-NUIM's files of poses have this ending. Their world is the renderer's, whose y points up: poses are mirrored, so
// that y points down as in the images.
inline constexpr const char* kEndingOfIclNuim = ".gt.freiburg";

TruthFile read_groundtruth(const std::string& file, const TruthOptions& options = {});

}  // namespace rumi
