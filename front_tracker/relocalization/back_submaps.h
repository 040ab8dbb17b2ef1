// SPDX-License-Identifier: BSD-3-Clause
// Back submaps as places to relocalize in. They cover places where no front submap has been. At places that both cover,
// a back submap often has more landmarks, because all images of a window are matched with each other.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "front_tracker/relocalization/relocalizer.h"

namespace rumi::front_tracker {

class BackSubmaps {
 public:
  // `camera` and `pyramid` are those of the frames. At most options.back_keyframes keyframes are kept; the submaps with
  // the oldest images are dropped first.
  BackSubmaps(const Camera& camera, const TrackingOptions& options, const Pyramid& pyramid);

  // Adds a submap, or replaces the one with its id. Returns an Error, and changes nothing, if it cannot be used.
  Result<> add(Submap submap);
  // Does nothing if there is no submap with this id.
  void remove(int id);

  struct Found {
    Submap submap;  // keyframes and landmarks are numbered from 0, the keyframes in order of time
    Frame frame;    // has its pose in the submap and its matches
  };
  // Looks for the frame in the submaps. Takes the submap in which it is found out of this collection; returns nullopt
  // if it is not found.
  std::optional<Found> relocalize(const Frame& frame);

  size_t submaps() const { return submaps_.size(); }
  int keyframes() const;

 private:
  struct Entry {
    size_t number = 0;  // submap_index in relocalizer_
    Submap submap;
  };
  void remove(std::vector<Entry>::iterator entry);

  Camera camera_;
  TrackingOptions options_;
  Pyramid pyramid_;
  std::vector<Entry> submaps_;  // in order of their oldest images
  size_t next_number_ = 0;
  Relocalizer relocalizer_;
};

}  // namespace rumi::front_tracker
