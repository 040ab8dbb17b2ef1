// SPDX-License-Identifier: BSD-3-Clause
// Finds landmarks of two places that may be the same point: by descriptor alone, or near the pixel to which a
// similarity projects them.
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "map_server/places/place_neighbourhood.h"
#include "slam/geometry/transform.h"

namespace rumi::map_server {

struct PlaceMatchOptions {
  int max_distance = 60;          // largest Hamming distance, of 256 bits
  double max_ratio = 0.8;         // best over second best distance, for matching by descriptor alone
  double octave_tolerance = 1.6;  // largest difference between expected and detected octave
  double min_view_cosine = 0.5;   // least cosine of the angle between the rays to a landmark from the two places
};

// A match: the indices of two landmarks in PlaceNeighbourhood::landmarks, and the keypoints whose descriptors matched.
struct PlaceMatch {
  int a = kNone, b = kNone;
  PlaceSighting in_a, in_b;
  int distance = 0;  // Hamming distance of the descriptors
};

// Finds pairs of landmarks by descriptor alone: views of a are compared with views of b, and each match is a vote for a
// pair.
class PlaceProposals {
 public:
  // Keeps references to its arguments.
  PlaceProposals(const PlaceNeighbourhood& a, const PlaceNeighbourhood& b, const PlaceMatchOptions& options)
      : a_(a), b_(b), options_(options) {}

  void compare(size_t view_a, size_t view_b);
  // Returns the pairs with most votes first, each landmark once.
  std::vector<PlaceMatch> ranked() const;

 private:
  struct Votes {
    int count = 0;
    PlaceMatch best;
  };
  const PlaceNeighbourhood& a_;
  const PlaceNeighbourhood& b_;
  const PlaceMatchOptions& options_;
  std::map<std::pair<int, int>, Votes> votes_;  // by the landmarks' indices in a and b
};

// Returns matches found by projecting the landmarks of a into the views of b. The match must project back, too, within
// radius_px (at octave 0). Each landmark occurs at most once.
std::vector<PlaceMatch> guided_matches(const PlaceNeighbourhood& a, const PlaceNeighbourhood& b, const Sim3& b_from_a,
                                       double radius_px, const PlaceMatchOptions& options);

// How well a keyframe confirms a similarity that was estimated without it: how many of the landmarks `from` should be
// in its view, and how many of these have a matching keypoint within radius_px.
struct Witness {
  int visible = 0;
  int found = 0;
  // Visible landmarks that should look the same and have others around them, and those of them around which hardly any
  // is found. A detector misses landmarks here and there, but where a thing is missing, a whole neighbourhood is
  // silent.
  int telling = 0;
  int silent = 0;
};
Witness hear_witness(const PlaceNeighbourhood& from, const Submap& to, const PlaceView& witness,
                     const Sim3& to_from_from, double radius_px, const PlaceMatchOptions& options);

}  // namespace rumi::map_server
