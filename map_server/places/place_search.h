// SPDX-License-Identifier: BSD-3-Clause
// Searches all submaps for places seen twice. Each keyframe is searched for once when it is new, and again if its
// submap is still not joined to the map when the submap has changed. PlaceLinks holds what was searched for and found,
// and each search continues from the PlaceLinks that it is given.
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
  int candidates = 3;       // keyframes that are compared with each new one, at most
  int min_alike = 8;        // least number of similar landmarks in the two images; below it they are not aligned
  double min_apart_s = 5;   // least time between two keyframes of one submap that are compared
  double separation_s = 1;  // least time between two candidates of one submap
  // A keyframe of a submap that is in the map is searched for once it is so old: then more is known of its landmarks.
  double settled_s = 5;
  double once_within_s = 2;  // a place is not searched for again if a found link is this near at both ends, in time
  // A poster that hangs in two rooms can deceive one alignment. So an alignment counts only if another one, of other
  // keyframes, agrees with it within these bounds.
  double confirm_within_s = 5;
  double confirm_rotation_deg = 5;
  double confirm_log_scale = 0.15;
  double confirm_translation = 0.15;  // largest difference of the positions, as a share of the median depth
  // Least standard deviations of a joint, because those of an alignment ignore how much the submaps are bent there.
  double sigma_rotation_deg = 0.5;
  double sigma_translation = 0.02;  // as a share of the median depth
  double sigma_log_scale = 0.02;
};

class PlaceSearch {
 public:
  // Returns true if the map already knows how two places lie relative to each other.
  using Joined = std::function<bool(const Place&, const Place&)>;

  explicit PlaceSearch(const PlaceSearchOptions& options) : o_(options) {}

  // Searches for each keyframe that is not known yet, but those for which `waits` is true: they are left for a later
  // search. If joined keyframes show the same image, searches for only one.
  void search(const Submaps& submaps, const Joined& joined, PlaceLinks* links,
              const std::function<bool(const Place&)>& waits = {});

  // Adds a submap whose keyframes may be found, but are not searched for.
  void add(const Submap& submap, PlaceLinks* links);

  // Searches once more for all keyframes of these submaps that changed since the last time, with the landmarks that all
  // submaps have now. Returns false if none has changed.
  bool search_again(const std::set<SubmapKey>& alone, const Submaps& submaps, const Joined& joined, PlaceLinks* links);

 private:
  bool make_known(const Submap& submap, const Keyframe& keyframe, PlaceLinks* links);
  void forget_removed(const Submaps& submaps, PlaceLinks* links);
  void search(const Place& place, const Submaps& submaps, const Joined& joined, PlaceLinks* links) const;
  bool is_known(const std::vector<LinkEdge>& found, const Place& a, const Place& b) const;
  void take(LinkEdge edge, double median_depth, const Submaps& submaps, PlaceLinks* links) const;
  bool agree(const LinkEdge& x, double median_depth, const LinkEdge& y, const Submaps& submaps) const;

  PlaceSearchOptions o_;
  PlaceIndex index_;  // index of the keyframes in PlaceLinks; updated before each search
};

}  // namespace rumi::map_server
