// SPDX-License-Identifier: BSD-3-Clause
// Finds the true path of a recording, in its dataset or in the bag.
#pragma once

#include <string>

#include "formats/truth/truth.h"

namespace rumi::tool {

struct FoundTruth {
  std::string file;              // empty if there is no truth
  double frames_per_second = 0;  // only for a truth that counts images (ICL-NUIM); 0: the truth has times
  std::string error;             // if there is no truth: where it was looked for
};
// Looks for the truth beside a recording of TUM RGB-D, EuRoC, TUM-VI, ICL-NUIM or `rumi import`, and in a bag.
FoundTruth find_truth(const std::string& recording);

// As read_groundtruth(); from a bag it takes the camera's poses in the transforms.
TruthFile read_truth(const std::string& file, const TruthOptions& options);

}  // namespace rumi::tool
