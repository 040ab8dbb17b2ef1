// SPDX-License-Identifier: BSD-3-Clause
// Back submaps as places to relocalize in. They know places where no front submap has been, and where both have been
// they often have more landmarks: all images of a window are matched with each other.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "front_tracker/relocalization/relocalizer.h"

namespace rumi::front_tracker {

class BackSubmaps {
 public:
  // The camera is that of the frames, octave_scales those of their keypoints. At most options.back_keyframes keyframes
  // are kept; the submaps of the oldest images go first.
  BackSubmaps(const Camera& camera, const TrackingOptions& options, const Pyramid& pyramid);

  // Replaces the submap of the same id. Returns why it was refused, or an empty string.
  std::string add(Submap submap);
  // Nothing happens where there is none of that id.
  void remove(int id);

  // The submap in which the frame was found: the frame has a pose in it then, and its matches. It is not kept any
  // longer. Its keyframes and landmarks are numbered from 0 on, the keyframes in order of time.
  std::optional<Submap> relocalize(Frame* frame);

  size_t submaps() const { return submaps_.size(); }
  int keyframes() const;

 private:
  struct Entry {
    size_t number = 0;  // in the relocalizer
    Submap submap;
  };
  void remove(std::vector<Entry>::iterator entry);

  Camera camera_;
  TrackingOptions options_;
  Pyramid pyramid_;
  std::vector<Entry> submaps_;  // in order of time
  size_t next_number_ = 0;
  Relocalizer relocalizer_;
};

}  // namespace rumi::front_tracker
