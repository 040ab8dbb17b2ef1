// SPDX-License-Identifier: BSD-3-Clause
// Looks through the submaps for places seen twice. It searches for each keyframe once when it is new, and once more if
// its submap is joined to nothing when more is known of it. PlaceLinks says what was searched for and found; a search
// goes on from the PlaceLinks that it is given.
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
  int candidates = 3;        // keyframes that are compared with each new one
  int min_alike = 8;         // landmarks of the two images that look alike: with fewer they are not aligned
  double min_apart_s = 5;    // in time, within a submap
  double separation_s = 1;   // between candidates of one submap
  double once_within_s = 2;  // a place within this time of one that was found, at both ends, is not searched for again
  // A poster that hangs in two rooms can deceive one alignment. So an alignment counts only when another one, of other
  // keyframes, agrees.
  double confirm_within_s = 5;
  double confirm_rotation_deg = 5;
  double confirm_log_scale = 0.15;
  double confirm_translation = 0.15;  // of the median depth
  // The least standard deviations of a joint: the sigmas of an alignment do not know how much submaps are bent there.
  double sigma_rotation_deg = 0.5;
  double sigma_translation = 0.02;  // of the median depth
  double sigma_log_scale = 0.02;
};

class PlaceSearch {
 public:
  // Says whether the map knows already how two places lie to each other.
  using Joined = std::function<bool(const Place&, const Place&)>;

  explicit PlaceSearch(const PlaceSearchOptions& options) : o_(options) {}

  // Searches for the keyframes that are not known yet; of joined keyframes of one image only for one.
  void search(const Submaps& submaps, const Joined& joined, PlaceLinks* links);

  // Adds a submap whose keyframes may be found but are not searched for.
  void add(const Submap& submap, PlaceLinks* links);

  // Searches once more for all keyframes of these submaps, with the landmarks that all submaps have by now, unless the
  // submaps have not changed since the last time. Returns false if it searched for nothing.
  bool search_again(const std::set<SubmapKey>& alone, const Submaps& submaps, const Joined& joined, PlaceLinks* links);

 private:
  bool make_known(const Submap& submap, const Keyframe& keyframe, PlaceLinks* links);
  void forget_removed(const Submaps& submaps, PlaceLinks* links);
  void search(const Place& place, const Submaps& submaps, const Joined& joined, PlaceLinks* links) const;
  bool is_known(const std::vector<LinkEdge>& found, const Place& a, const Place& b) const;
  void take(LinkEdge edge, double median_depth, const Submaps& submaps, PlaceLinks* links) const;
  bool agree(const LinkEdge& x, double median_depth, const LinkEdge& y, const Submaps& submaps) const;

  PlaceSearchOptions o_;
  PlaceIndex index_;  // of the keyframes that PlaceLinks knows; it is brought up to date before a search
};

}  // namespace rumi::map_server
