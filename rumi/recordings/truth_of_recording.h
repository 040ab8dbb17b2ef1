// SPDX-License-Identifier: BSD-3-Clause
// Finds the true path of a recording, in its dataset or in the bag.
#pragma once

#include <string>

#include "formats/truth/truth.h"

namespace rumi::tool {

struct FoundTruth {
  std::string file;              // empty if there is none
  double frames_per_second = 0;  // for a truth that counts images (ICL-NUIM); 0: it has times
  std::string error;             // where it was looked for
};
// Looks beside a recording of TUM RGB-D, EuRoC, TUM-VI or ICL-NUIM, or of `rumi import`, and in a bag.
FoundTruth find_truth(const std::string& recording);

// As read_groundtruth(), but takes from a bag the camera's poses in its transforms.
TruthFile read_truth(const std::string& file, const TruthOptions& options);

}  // namespace rumi::tool
