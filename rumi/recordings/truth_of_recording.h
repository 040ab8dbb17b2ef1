// SPDX-License-Identifier: BSD-3-Clause
// The true path of a recording: where its download has it, and out of a bag.
#pragma once

#include <string>

#include "formats/truth/truth.h"

namespace rumi::tool {

struct FoundTruth {
  std::string file;              // empty if there is none
  double frames_per_second = 0;  // of what counts images (ICL-NUIM); 0: it has times
  std::string error;             // where it was looked for
};
// Beside a recording of TUM RGB-D, EuRoC, TUM-VI or ICL-NUIM, or of `rumi import`; a bag may have it itself.
FoundTruth find_truth(const std::string& recording);

// As read_groundtruth(); of a bag the camera's poses by its transforms of frames.
TruthFile read_truth(const std::string& file, const TruthOptions& options);

}  // namespace rumi::tool
