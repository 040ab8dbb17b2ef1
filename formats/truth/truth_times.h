// SPDX-License-Identifier: BSD-3-Clause
// Interprets the times of a truth: finds their unit, and tells times from numbers of images; reads times from another
// file.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/text/time_units.h"
#include "formats/truth/truth.h"
#include "formats/truth/truth_lines.h"

namespace rumi {

// Converts a time to microseconds; nullopt if it is so far from 0 that differences of times could overflow.
std::optional<int64_t> to_us(const RawTime& time, double per_second);
// True if all times are whole numbers, and small enough to be numbers of images.
bool are_small_and_whole(const std::vector<RawPose>& poses);
// True if the times are 1, 2, 3, ... although the images are not a second apart.
bool are_numbers_of_images(const std::vector<RawPose>& poses, const TruthOptions& options);
// Finds the unit of the times. Times since 1970 tell it by their size; for other times it is the unit in which they
// overlap with those of the images.
TimeUnit unit_of(const std::vector<RawPose>& poses, const TruthOptions& options);
// Reads KITTI's times.txt, one time in seconds a line: beside the poses, above them, or in the sequence of the same
// number. *file becomes its name. Returns nullopt if there is no such file.
std::optional<std::vector<double>> read_times(const std::string& truth_file, std::string* file);

}  // namespace rumi
