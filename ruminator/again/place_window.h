// SPDX-License-Identifier: BSD-3-Clause
// A window by place: images that the map lacks, with those images of the map that look like them or are near them in
// time. A window by time (WindowSampler) has only what lies around one loss.
#pragma once

#include <cstdint>
#include <functional>
#include <set>
#include <vector>

#include "ruminator/window/rumination_window.h"

namespace rumi::ruminator {

// An image that may be taken into a window.
struct WindowCandidate {
  static constexpr int kInMap = -1;
  Sample sample;
  int island = kInMap;  // the island that it belongs to
};

// Frames that belong together and are not in the map: a submap, or successive frames without poses.
struct Island {
  int id = 0;
  int64_t frames = 0;  // how many the map would gain
};

// How much two candidates look alike: from -1 to 1, where 1 is the same image.
using Similarity = std::function<double(size_t, size_t)>;

// How many images a window by place has, at most.
inline constexpr int kPlaceWindowImages = 320;

struct PlaceWindow {
  std::vector<WindowCandidate> candidates;  // in order of time
  std::set<int> islands;                    // those of which it has an image
};

// Chooses a window around the island `seed`. It grows image by image: the next one is always the one that looks most
// like an image that is in already, so that images overlap. Images of the map fill the rest. `candidates` are in order
// of time. Returns an empty window if the island has no candidate.
PlaceWindow choose_place_window(const std::vector<WindowCandidate>& candidates, int seed, const Similarity& similarity,
                                int max_images);

}  // namespace rumi::ruminator
