// SPDX-License-Identifier: BSD-3-Clause
// Ruminates again at the end of a replay: what the map lacks is rebuilt together with the images that look like it,
// wherever in the recording they are, round by round, as long as a round wins frames.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <set>
#include <vector>

#include "camera_driver/source/image_source.h"
#include "map_server/atlas/atlas.h"
#include "ruminator/again/place_window.h"
#include "ruminator/ruminator_node.h"

namespace rumi::tool {

// Frames of a session that are not in the map, grouped: a submap each, or rows of frames without poses.
struct Islands {
  std::vector<ruminator::Island> all;
  std::vector<ruminator::PlaceCandidate> candidates;  // of the islands and of the map, in order of time
  int64_t frames = 0;                                 // not in the map
};
Islands find_islands(const map_server::Atlas& atlas, int64_t session, int64_t stream);

class Again {
 public:
  struct System {
    const map_server::Atlas& atlas;
    camera_driver::ImageSource& recording;
    ruminator::RuminatorNode& ruminator;
    std::function<void()> settle;   // returns when everything that was handed on has become part of the map, or not
    std::function<double()> cpu_s;  // so far
    const std::atomic<bool>* stop = nullptr;  // may be null
  };
  explicit Again(System system) : system_(std::move(system)) {}

  // Ends when a round wins nothing, when the CPU time is spent, or when it is called off.
  void run(double budget_s);

 private:
  bool round(int number);
  std::vector<image_t> images(const std::set<int64_t>& utimes_us);

  System system_;
};

}  // namespace rumi::tool
