// SPDX-License-Identifier: BSD-3-Clause
// What the times of a truth are: their unit, numbers of images, or those of another file.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/time_units.h"
#include "rumi/evaluation/truth.h"
#include "rumi/evaluation/truth_lines.h"

namespace rumi::tool {

// Nothing where it is too far from 0 for the difference of two times.
std::optional<int64_t> to_us(const RawTime& time, double per_second);
// As a count of images is.
bool are_small_and_whole(const std::vector<RawPose>& poses);
// 1, 2, 3, ...: seconds only where the images are a second apart, too.
bool are_numbers_of_images(const std::vector<RawPose>& poses, const TruthOptions& options);
// That of the times' size; or, where they are not since 1970, the one in which they are those of the images.
TimeUnit unit_of(const std::vector<RawPose>& poses, const TruthOptions& options);
// KITTI's times.txt, a second a line: beside the poses, above them, or in the sequence of the same number.
std::optional<std::vector<double>> read_times(const std::string& truth_file, std::string* file);

}  // namespace rumi::tool
