// SPDX-License-Identifier: BSD-3-Clause
// A window by place: images that the map lacks (islands), with those images of the map that look like them or are near
// them in time. A window by time (WindowSampler) has only what lies around one loss.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "ruminator/window/rumination_window.h"

namespace rumi::ruminator {

// An image that may be taken into the window.
struct PlaceCandidate {
  static constexpr int kInMap = -1;
  Sample sample;
  int island = kInMap;  // the island that it belongs to
};

// Frames that hang together and are not in the map: a submap, or a row of frames without poses.
struct Island {
  int id = 0;
  int64_t frames = 0;  // what the map would win
};

// From 0 (nothing in common) to 1, of two candidates.
using Similarity = std::function<double(size_t, size_t)>;

// How many images of a window by place, at most. The price of a window grows with the square.
inline constexpr int kPlaceWindowImages = 140;

// The chosen candidates in order of time. The larger islands come first; `taken` says which ones are in the window.
// Candidates are in order of time.
std::vector<size_t> choose_place_window(const std::vector<PlaceCandidate>& candidates, std::vector<Island> islands,
                                        const Similarity& similarity, int max_images, std::vector<int>* taken);

}  // namespace rumi::ruminator
