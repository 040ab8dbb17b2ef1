// SPDX-License-Identifier: BSD-3-Clause
// Ruminates again at the end of a replay: what the map lacks is rebuilt together with the images that look like it,
// wherever in the recording they are, window by window, as long as that wins frames.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <vector>

#include "camera_driver/source/image_source.h"
#include "map_server/atlas/atlas.h"
#include "ruminator/again/image_similarity.h"
#include "ruminator/again/place_window.h"
#include "ruminator/ruminator_node.h"

namespace rumi::tool {

// The frames of a session that are not in the map.
struct Islands {
  std::vector<ruminator::Island> all;                  // `id` is the index
  std::vector<ruminator::WindowCandidate> candidates;  // images of the islands and of the map, in order of time
  int64_t frames = 0;                                  // of all islands
};
Islands find_islands(const map_server::Atlas& atlas, int64_t session, int64_t stream);

class Again {
 public:
  struct System {
    const map_server::Atlas& atlas;
    camera_driver::ImageSource& recording;
    ruminator::RuminatorNode& ruminator;
    std::function<void()> settle;             // returns when all that is under way has come into the map, or cannot
    const std::atomic<bool>* stop = nullptr;  // may be null
  };
  explicit Again(System system) : system_(std::move(system)) {}

  // Ends when a round wins next to nothing, when the windows have had `most_images`, or when it is called off. (A limit
  // of the CPU time would make the result depend on the machine.)
  void run(int64_t most_images);

 private:
  bool round(int number);
  Islands look() const;
  bool index(const Islands& islands);
  void add_to_index(const std::set<int64_t>& utimes_us);
  ruminator::PlaceWindow next_window(const Islands& islands);
  void rebuild(const ruminator::PlaceWindow& window);
  std::vector<image_t> images(const std::set<int64_t>& utimes_us);
  bool is_over() const;
  bool are_few(int64_t frames) const;

  System system_;
  int64_t images_left_ = 0;
  ruminator::ImageSimilarity index_;
  std::map<int64_t, size_t> number_in_index_;  // by utime
  std::set<int64_t> tried_;                    // utimes of images of islands in the windows of this round
};

}  // namespace rumi::tool
