// SPDX-License-Identifier: BSD-3-Clause
// Matches landmarks of two places that may be the same point: by descriptor alone, or near where a similarity puts
// them.
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "map_server/places/place_neighbourhood.h"
#include "slam/geometry/transform.h"

namespace rumi::map_server {

struct PlaceMatchOptions {
  int max_distance = 60;          // Hamming, of 256 bits
  double max_ratio = 0.8;         // best over second best, where nothing but the descriptor decides
  double octave_tolerance = 1.6;  // octaves between where a landmark should appear and where it does
  double min_view_cosine = 0.5;   // between the rays of the two places to a landmark
};

// A match: indices into PlaceNeighbourhood::landmarks, and the two keypoints whose descriptors matched.
struct PlaceMatch {
  int a = kNone, b = kNone;
  PlaceSighting in_a, in_b;
  int distance = 0;  // Hamming
};

// Finds landmark pairs by descriptor alone: it compares views of a with views of b (match_features), which vote for
// pairs.
class PlaceProposals {
 public:
  // Keeps references to its arguments.
  PlaceProposals(const PlaceNeighbourhood& a, const PlaceNeighbourhood& b, const PlaceMatchOptions& options)
      : a_(a), b_(b), options_(options) {}

  void compare(size_t view_a, size_t view_b);
  // Returns the pairs that most comparisons found first, each landmark once.
  std::vector<PlaceMatch> ranked() const;

 private:
  struct Votes {
    int count = 0;
    PlaceMatch best;
  };
  const PlaceNeighbourhood& a_;
  const PlaceNeighbourhood& b_;
  const PlaceMatchOptions& options_;
  std::map<std::pair<int, int>, Votes> votes_;  // by landmarks
};

// Projects landmarks of a into the views of b and back, and matches within radius_px at octave 0; each landmark once.
std::vector<PlaceMatch> guided_matches(const PlaceNeighbourhood& a, const PlaceNeighbourhood& b, const Sim3& b_from_a,
                                       double radius_px, const PlaceMatchOptions& options);

// Says how well a keyframe that had no part in the similarity confirms it: how many of the landmarks `from` should be
// in its view, and how many of these have a matching keypoint within radius_px.
struct Witness {
  int visible = 0;
  int found = 0;
};
Witness hear_witness(const PlaceNeighbourhood& from, const Submap& to, const PlaceView& witness,
                     const Sim3& to_from_from, double radius_px, const PlaceMatchOptions& options);

}  // namespace rumi::map_server
