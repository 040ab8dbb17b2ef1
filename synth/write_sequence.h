// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

#include "synth/options.h"

namespace rumi::synth {

// Called after each frame with the number of frames written and of all frames. Returns false to stop.
using SynthProgress = std::function<bool(int, int)>;

// Renders a sequence into a folder as of TUM RGB-D: rgb/TIME.jpg, rgb.txt, groundtruth.txt (map_from_cam: t tx ty tz qx
// qy qz qw), calibration.yaml. Makes the folder if needed; refuses one that has an rgb.txt, unless `overwrite`. An
// Error names the option or the file, and the reason; it is "stopped" if `progress` returned false.
Result<> write_sequence(const SynthOptions& options, const std::string& folder, bool overwrite,
                        const SynthProgress& progress);

}  // namespace rumi::synth
