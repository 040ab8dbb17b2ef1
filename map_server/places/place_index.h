// SPDX-License-Identifier: BSD-3-Clause
// Finds the places in the atlas that look like an image. It indexes the keyframes of all submaps by the descriptors of
// their landmarks.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include "slam/features/keyframe_index.h"
#include "slam/map/submap.h"

namespace rumi::map_server {

struct Place {
  SubmapKey submap;
  int keyframe = kNone;  // id of the keyframe in its submap
  ImageId image = {};
  bool operator==(const Place&) const = default;
};

struct PlaceCandidate {
  Place place;
  double score = 0;  // similarity, as KeyframeIndex computes it
};

class PlaceIndex {
 public:
  // Adds the keyframe, or replaces its entry. Only keypoints that observe a landmark count.
  void add(const Submap& submap, const Keyframe& keyframe);
  void remove(SubmapKey submap, int keyframe);
  void remove_if(const std::function<bool(const Place&)>& gone);
  bool contains(SubmapKey submap, int keyframe) const { return numbers_.contains({submap, keyframe}); }
  size_t size() const { return numbers_.size(); }

  // Returns at most `count` candidates, the best first, without those for which `exclude` is true. If several keyframes
  // of one submap lie within `separation_us` of each other, returns only the best of them, because the others show the
  // same place. Ties are broken by the order in which keyframes were added.
  std::vector<PlaceCandidate> query(const std::vector<Descriptor>& descriptors, size_t count, int64_t separation_us,
                                    const std::function<bool(const Place&)>& exclude) const;

 private:
  KeyframeIndex index_;
  int64_t next_number_ = 0;
  std::map<std::pair<SubmapKey, int>, int64_t> numbers_;
  std::map<int64_t, Place> places_;
};

// Returns the keypoints that observe a landmark.
std::vector<int> landmark_keypoints(const Keyframe& keyframe);

// Returns the descriptors of these keypoints. Keyframes are indexed by them, and should be searched for with them.
std::vector<Descriptor> landmark_descriptors(const Keyframe& keyframe);

// Returns the `exclude` of query() for a keyframe: it is true for the keyframe itself, for keyframes that share
// landmarks with it, and for those of its submap within `min_apart_us` of it.
std::function<bool(const Place&)> exclude_surroundings(const Submap& submap, int keyframe, int64_t min_apart_us);

}  // namespace rumi::map_server
