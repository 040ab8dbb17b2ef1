// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

#include "synth/options.h"

namespace rumi::synth {

// Called after each frame with the number written and the number in all; false stops.
using SynthProgress = std::function<bool(int, int)>;

// Renders a sequence into a TUM-style folder: rgb/TIME.jpg, rgb.txt, groundtruth.txt (map_from_cam: t tx ty tz qx qy qz
// qw), calibration.yaml. The folder is made if needed; one that holds an rgb.txt already is refused unless `overwrite`.
// An Error names the option or the file, and the reason; it is "stopped" if `progress` said so.
Result<> write_sequence(const SynthOptions& options, const std::string& folder, bool overwrite,
                        const SynthProgress& progress);

}  // namespace rumi::synth
