// SPDX-License-Identifier: BSD-3-Clause
// Looks through the submaps for places seen twice: each keyframe once when it is new, and where a submap hangs on
// nothing once more when more is known of it.
#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "map_server/links/joint.h"
#include "map_server/links/link.h"
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

// A place seen twice.
struct PlaceLink {
  double median_depth = 0;  // of its landmarks, in the unit of b
  Link link;                // a: the submap of the keyframe searched for, b: of the one found
  int64_t utime_a_us = 0, utime_b_us = 0;
  KeyframeJoint joint;
  std::vector<LandmarkPair> landmarks;
};

class PlaceSearch {
 public:
  using Submaps = std::map<SubmapKey, const Submap*>;

  explicit PlaceSearch(const PlaceSearchOptions& options) : o_(options) {}

  // Searches for the keyframes that are new, once for those of one image that are joined. `joined`: the map knows
  // already how these two lie to each other.
  void search(const Submaps& submaps, const std::function<bool(const Place&, const Place&)>& joined);

  // Keyframes that may be found and are not searched for.
  void add(const Submap& submap);

  // Searches for all keyframes of these submaps once more, with the landmarks that all submaps have by now, unless that
  // was done and they are as they were then. False if nothing was searched for.
  bool search_again(const std::set<SubmapKey>& alone, const Submaps& submaps,
                    const std::function<bool(const Place&, const Place&)>& joined);

  const std::vector<PlaceLink>& found() const { return found_; }
  // This one of them turned out to be wrong.
  void refuse(int found, const std::string& doubt);
  // The last refusal between two submaps that nothing joins, for whoever wonders.
  const std::map<std::pair<SubmapKey, SubmapKey>, Link>& refused() const { return refused_; }

 private:
  void forget_removed(const Submaps& submaps);
  void search(const Place& place, const Submaps& submaps,
              const std::function<bool(const Place&, const Place&)>& joined);
  bool is_known(const Place& a, const Place& b) const;
  void take(PlaceLink link, const Submaps& submaps);
  bool agree(const PlaceLink& x, const PlaceLink& y, const Submaps& submaps) const;

  PlaceSearchOptions o_;
  PlaceIndex index_;
  std::set<std::pair<SubmapKey, int>> seen_;
  std::map<SubmapKey, int64_t> searched_again_;  // at this revision
  std::map<ImageId, std::vector<Place>> searched_for_;
  std::vector<PlaceLink> found_;
  std::vector<PlaceLink> unconfirmed_;
  std::map<std::pair<SubmapKey, SubmapKey>, Link> refused_;
};

}  // namespace rumi::map_server
