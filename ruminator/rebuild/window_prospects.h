// SPDX-License-Identifier: BSD-3-Clause
// Can a window be rebuilt at all? These tests refuse hopeless windows before time is spent on them. Each function
// returns the reason, a sentence for a person, or an empty string.
#pragma once

#include <atomic>
#include <set>
#include <string>
#include <vector>

#include "ruminator/rebuild/build_options.h"
#include "ruminator/window/window_job.h"

namespace rumi::ruminator {

// Looks at a few images of a long gap: do they show anything?
std::string find_blind_gap(const WindowJob& job, const BuildOptions& options);

// Does the camera move, and do matches connect the images of the gap with those around it? camera: of the features;
// utimes: of the images.
std::string find_hopeless(const WindowJob& job, const Camera& camera, const std::vector<int64_t>& utimes_us,
                          const std::vector<SiftFeatures>& images, const std::vector<ImagePair>& pairs,
                          const BuildOptions& options);

// Do the images in `which` show depth? For each image, the pairs that are farthest apart and the pair with the most
// parallax are tested. Three images must take part in pairs that show depth. Matches are the verified ones. Returns an
// empty string if it is cancelled.
std::string find_no_depth(const Camera& camera, const std::vector<SiftFeatures>& images,
                          const std::vector<ImagePair>& pairs, const std::set<int>& which,
                          const std::atomic<bool>& cancel);

// Do so many frames of the parts in one model serve a purpose: poses for the gap, or a bridge over it?
bool is_useful(int approach, int gap, int departure);

}  // namespace rumi::ruminator
