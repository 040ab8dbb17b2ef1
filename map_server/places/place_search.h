// SPDX-License-Identifier: BSD-3-Clause
// Looks through the submaps for places seen twice: each keyframe once when it is new, and where a submap hangs on
// nothing once more when more is known of it. What was searched for and found is in PlaceLinks; given those of before,
// it goes on from there.
#pragma once

#include <functional>
#include <set>
#include <vector>

#include "map_server/links/place_links.h"
#include "map_server/links/submaps.h"
#include "map_server/places/place_alignment.h"
#include "map_server/places/place_index.h"

namespace rumi::map_server {

struct PlaceSearchOptions {
  PlaceAlignmentOptions alignment;
  int candidates = 3;        // of a keyframe, that are compared
  int min_alike = 8;         // landmarks of the two images that look alike: with fewer they are not aligned
  double min_apart_s = 5;    // in time, within a submap
  double separation_s = 1;   // between candidates of one submap
  double once_within_s = 2;  // of a place that was found, at either end: no need to find it again
  // A poster that hangs in two rooms can deceive one alignment: it counts when another one, of other keyframes, agrees.
  double confirm_within_s = 5;
  double confirm_rotation_deg = 5;
  double confirm_log_scale = 0.15;
  double confirm_translation = 0.15;  // of the median depth
  // Of a joint, at least: what submaps are bent by where they were aligned is not in the sigmas of the alignment.
  double sigma_rotation_deg = 0.5;
  double sigma_translation = 0.02;  // of the median depth
  double sigma_log_scale = 0.02;
};

class PlaceSearch {
 public:
  // The map knows already how these two lie to each other.
  using Joined = std::function<bool(const Place&, const Place&)>;

  explicit PlaceSearch(const PlaceSearchOptions& options) : o_(options) {}

  // Searches for the keyframes that are not known yet, once for those of one image that are joined.
  void search(const Submaps& submaps, const Joined& joined, PlaceLinks* links);

  // Its keyframes may be found and are not searched for.
  void add(const Submap& submap, PlaceLinks* links);

  // Searches for all keyframes of these submaps once more, with the landmarks that all submaps have by now, unless that
  // was done and they are as they were then. False if nothing was searched for.
  bool search_again(const std::set<SubmapKey>& alone, const Submaps& submaps, const Joined& joined, PlaceLinks* links);

 private:
  bool make_known(const Submap& submap, const Keyframe& keyframe, PlaceLinks* links);
  void forget_removed(const Submaps& submaps, PlaceLinks* links);
  void search(const Place& place, const Submaps& submaps, const Joined& joined, PlaceLinks* links) const;
  bool is_known(const std::vector<LinkEdge>& found, const Place& a, const Place& b) const;
  void take(LinkEdge edge, double median_depth, const Submaps& submaps, PlaceLinks* links) const;
  bool agree(const LinkEdge& x, double median_depth, const LinkEdge& y, const Submaps& submaps) const;

  PlaceSearchOptions o_;
  PlaceIndex index_;  // of what the links know: what it lacks is added, what it has too much is taken out
};

}  // namespace rumi::map_server
