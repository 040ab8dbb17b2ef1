// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/place_search.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace rumi {
namespace {

using Submaps = std::map<SubmapKey, const Submap*>;

Link make_link(const Place& a, const Place& b, const PlaceAlignment& alignment) {
  return {.a = a.submap,
          .b = b.submap,
          .kind = Link::Kind::kAppearance,
          .b_from_a = alignment.b_from_a,
          .keyframes = static_cast<int>(alignment.heard.size()),
          .keyframe_inliers = alignment.witnesses_a + alignment.witnesses_b,
          .landmarks = alignment.guided,
          .landmark_inliers = alignment.inliers,
          .rmse_px = alignment.rmse_px,
          .doubt = alignment.doubt};
}

PlaceLink make_place_link(const Place& a, const Place& b, const Submaps& submaps, PlaceAlignment alignment) {
  PlaceLink found{make_link(a, b, alignment), a.utime_us, b.utime_us, {}, std::move(alignment.landmarks)};
  const SE3& cam_from_a = submaps.at(a.submap)->keyframe(a.keyframe)->cam_from_submap;
  const SE3& cam_from_b = submaps.at(b.submap)->keyframe(b.keyframe)->cam_from_submap;
  found.joint = {{a.submap, a.keyframe},
                 {b.submap, b.keyframe},
                 Sim3(cam_from_b) * alignment.b_from_a * Sim3(cam_from_a.inverse()),
                 alignment.sigma_rotation_rad,
                 alignment.sigma_translation * alignment.median_depth,
                 alignment.sigma_log_scale};
  return found;
}

}  // namespace

void PlaceSearch::search(const Submaps& submaps, const std::function<bool(const Place&, const Place&)>& joined) {
  std::vector<Place> fresh;
  for (const auto& [key, submap] : submaps)
    for (const auto& [id, keyframe] : submap->keyframes)
      if (searched_.insert({key, id}).second) {
        index_.add(key, keyframe);
        fresh.push_back({key, id, keyframe.utime_us});
      }
  for (const Place& place : fresh) search(place, submaps, joined);
}

bool PlaceSearch::is_known(const Place& a, const Place& b) const {
  const auto near = [&](SubmapKey key, int64_t utime_us, const Place& place) {
    return key == place.submap && std::abs(utime_us - place.utime_us) < o_.once_within_s * 1e6;
  };
  return std::any_of(found_.begin(), found_.end(), [&](const PlaceLink& known) {
    return (near(known.link.a, known.utime_a_us, a) && near(known.link.b, known.utime_b_us, b)) ||
           (near(known.link.a, known.utime_a_us, b) && near(known.link.b, known.utime_b_us, a));
  });
}

void PlaceSearch::search(const Place& place, const Submaps& submaps,
                         const std::function<bool(const Place&, const Place&)>& joined) {
  const Submap& submap = *submaps.at(place.submap);
  const auto surroundings = exclude_surroundings(submap, place.keyframe, static_cast<int64_t>(o_.min_apart_s * 1e6));
  const auto exclude = [&](const Place& other) {
    const auto owner = submaps.find(other.submap);
    return owner == submaps.end() || !owner->second->keyframe(other.keyframe) || surroundings(other) ||
           is_known(place, other) || joined(place, other);
  };
  const std::vector<PlaceCandidate> candidates =
      index_.query(landmark_descriptors(*submap.keyframe(place.keyframe)), static_cast<size_t>(o_.candidates),
                   static_cast<int64_t>(o_.separation_s * 1e6), exclude);
  for (const PlaceCandidate& candidate : candidates) {
    const Place& other = candidate.place;
    PlaceAlignment alignment =
        align_places(submap, place.keyframe, *submaps.at(other.submap), other.keyframe, o_.alignment);
    if (alignment.doubt.empty()) {
      found_.push_back(make_place_link(place, other, submaps, std::move(alignment)));
      return;
    }
    if (place.submap != other.submap)
      refused_[std::minmax(place.submap, other.submap)] = make_link(place, other, alignment);
  }
}

}  // namespace rumi
