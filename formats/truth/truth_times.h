// SPDX-License-Identifier: BSD-3-Clause
// Interprets the times of a truth: their unit, or whether they are numbers of images or belong to another file.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/text/time_units.h"
#include "formats/truth/truth.h"
#include "formats/truth/truth_lines.h"

namespace rumi {

// Returns nothing for a time so far from 0 that differences of times could overflow.
std::optional<int64_t> to_us(const RawTime& time, double per_second);
// True if all times are whole numbers, and small enough to be numbers of images.
bool are_small_and_whole(const std::vector<RawPose>& poses);
// The times are 1, 2, 3, ... although the images are not a second apart.
bool are_numbers_of_images(const std::vector<RawPose>& poses, const TruthOptions& options);
// Times since 1970 tell their unit by their size. For other times it is the unit in which they overlap with those of
// the images.
TimeUnit unit_of(const std::vector<RawPose>& poses, const TruthOptions& options);
// Reads KITTI's times.txt, one time in seconds a line: beside the poses, above them, or in the sequence of the same
// number. *file becomes its name.
std::optional<std::vector<double>> read_times(const std::string& truth_file, std::string* file);

}  // namespace rumi
