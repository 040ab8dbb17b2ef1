// SPDX-License-Identifier: BSD-3-Clause
// Is there anything to be had from a window? What cannot be rebuilt is told before time is spent on it. Each function
// returns the reason why there is nothing, a sentence for a person, or an empty string.
#pragma once

#include <atomic>
#include <set>
#include <string>
#include <vector>

#include "ruminator/build/build_options.h"
#include "ruminator/window/window_job.h"

namespace rumi::ruminator {

// A look at a few images of a long gap: is there anything to be seen in them?
std::string find_blind_gap(const WindowJob& job, const BuildOptions& options);

// Does the camera move, and do the images of the gap hang together with those around it? camera: of the features;
// utimes: of the images.
std::string find_hopeless(const WindowJob& job, const Camera& camera, const std::vector<int64_t>& utimes_us,
                          const std::vector<SiftFeatures>& images, const std::vector<ImagePair>& pairs,
                          const BuildOptions& options);

// Do the images show depth, those numbered in `which`? Of each the pairs are looked at that are farthest apart, and the
// one with the most parallax; three images must take part in those that show it. Matches are the verified ones. Nothing
// is said if it is called off.
std::string find_no_depth(const Camera& camera, const std::vector<SiftFeatures>& images,
                          const std::vector<ImagePair>& pairs, const std::set<int>& which,
                          const std::atomic<bool>& cancel);

// Do so many frames of the parts in one model serve a purpose: poses for the gap, or a bridge over it?
bool is_useful(int approach, int gap, int departure);

}  // namespace rumi::ruminator
