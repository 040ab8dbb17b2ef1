// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/places/place_search.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <utility>

#include "slam/features/matching.h"

namespace rumi::map_server {
namespace {

// most unconfirmed links that are kept; older ones go, because a confirmation comes within seconds or not at all
constexpr size_t kMostUnconfirmed = 1000;

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

LinkEdge make_edge(const Place& a, const Place& b, const Submaps& submaps, const PlaceSearchOptions& o,
                   const PlaceAlignment& alignment) {
  const double depth = alignment.median_depth;
  const SE3& cam_from_a = submaps.at(a.submap)->keyframe(a.keyframe)->cam_from_submap;
  const SE3& cam_from_b = submaps.at(b.submap)->keyframe(b.keyframe)->cam_from_submap;
  const KeyframeJoint joint{{a.submap, a.keyframe},
                            {b.submap, b.keyframe},
                            Sim3(cam_from_b) * alignment.b_from_a * Sim3(cam_from_a.inverse()),
                            std::max(alignment.sigma_rotation_deg, o.sigma_rotation_deg) * M_PI / 180,
                            std::max(alignment.sigma_translation, o.sigma_translation) * depth,
                            std::max(alignment.sigma_log_scale, o.sigma_log_scale)};
  return {make_link(a, b, alignment), a.image.utime_us, b.image.utime_us, {joint}, alignment.landmarks};
}

// Counts the landmarks of the two images that look alike. Some five do so by chance.
int alike(const Submap& a, int keyframe_a, const Submap& b, int keyframe_b, const PlaceMatchOptions& o) {
  const Keyframe &x = *a.keyframe(keyframe_a), &y = *b.keyframe(keyframe_b);
  const std::vector<int> in_x = landmark_keypoints(x), in_y = landmark_keypoints(y);
  if (in_x.empty() || in_y.empty()) return 0;  // match_features() would take an empty selection for all
  return static_cast<int>(
      match_features(*x.features, in_x, *y.features, in_y, {o.max_distance, o.max_ratio, true}).size());
}

// Returns the same link with a and b exchanged, without its joint and landmarks.
LinkEdge turned(const LinkEdge& x) {
  LinkEdge y{.link = x.link, .utime_a_us = x.utime_b_us, .utime_b_us = x.utime_a_us};
  std::swap(y.link.a, y.link.b);
  y.link.b_from_a = x.link.b_from_a.inverse();
  return y;
}

}  // namespace

bool PlaceSearch::make_known(const Submap& submap, const Keyframe& keyframe, PlaceLinks* links) {
  const bool is_new = links->known.insert({submap.key, keyframe.id}).second;
  if (is_new || !index_.contains(submap.key, keyframe.id)) index_.add(submap, keyframe);
  return is_new;
}

void PlaceSearch::search(const Submaps& submaps, const Joined& joined, PlaceLinks* links,
                         const std::function<bool(const Place&)>& waits) {
  forget_removed(submaps, links);
  std::vector<Place> fresh;
  for (const auto& [key, submap] : submaps)
    for (const auto& [id, keyframe] : submap->keyframes) {
      const Place place{key, id, submap->image(keyframe)};
      if (waits && !links->known.contains({key, id}) && waits(place)) continue;
      if (make_known(*submap, keyframe, links)) fresh.push_back(place);
    }
  for (const Place& place : fresh) {
    std::vector<KeyframeRef>& same_image = links->searched_for[place.image];
    // If a joined keyframe of the same image was searched for already, its result is valid for this one too.
    const bool known = std::any_of(same_image.begin(), same_image.end(), [&](const KeyframeRef& other) {
      return joined(place, {other.submap, other.id, place.image});
    });
    if (known) continue;
    same_image.push_back({place.submap, place.keyframe});
    search(place, submaps, joined, links);
  }
}

// Forgets keyframes that were removed. Without this the index would grow for ever, because front_tracker makes and
// removes keyframes all the time while it stays in one place.
void PlaceSearch::forget_removed(const Submaps& submaps, PlaceLinks* links) {
  const auto is_gone = [&](SubmapKey key, int keyframe) {
    const auto owner = submaps.find(key);
    return owner == submaps.end() || !owner->second->keyframe(keyframe);
  };
  index_.remove_if([&](const Place& place) { return is_gone(place.submap, place.keyframe); });
  std::erase_if(links->known, [&](const auto& keyframe) { return is_gone(keyframe.first, keyframe.second); });
  std::map<ImageId, std::vector<KeyframeRef>>& searched_for = links->searched_for;
  for (auto it = searched_for.begin(); it != searched_for.end();) {
    std::erase_if(it->second, [&](const KeyframeRef& keyframe) { return is_gone(keyframe.submap, keyframe.id); });
    it = it->second.empty() ? searched_for.erase(it) : std::next(it);
  }
}

void PlaceSearch::add(const Submap& submap, PlaceLinks* links) {
  for (const auto& [id, keyframe] : submap.keyframes) make_known(submap, keyframe, links);
}

bool PlaceSearch::search_again(const std::set<SubmapKey>& alone, const Submaps& submaps, const Joined& joined,
                               PlaceLinks* links) {
  std::vector<Place> places;
  for (const SubmapKey& key : alone) {
    const Submap& submap = *submaps.at(key);
    if (std::exchange(links->searched_again[key], submap.revision) == submap.revision) continue;
    for (const auto& [id, keyframe] : submap.keyframes) places.push_back({key, id, submap.image(keyframe)});
  }
  if (places.empty()) return false;
  forget_removed(submaps, links);
  // Builds the index anew, because removing a keyframe takes time for every keyframe that looks like it.
  index_ = {};
  for (const auto& [key, submap] : submaps)
    for (const auto& [id, keyframe] : submap->keyframes) index_.add(*submap, keyframe);
  for (const Place& place : places) search(place, submaps, joined, links);
  return true;
}

bool PlaceSearch::is_known(const std::vector<LinkEdge>& found, const Place& a, const Place& b) const {
  const auto near = [&](SubmapKey key, int64_t utime_us, const Place& place) {
    return key == place.submap &&
           static_cast<double>(std::abs(utime_us - place.image.utime_us)) < o_.once_within_s * 1e6;
  };
  return std::any_of(found.begin(), found.end(), [&](const LinkEdge& known) {
    return (near(known.link.a, known.utime_a_us, a) && near(known.link.b, known.utime_b_us, b)) ||
           (near(known.link.a, known.utime_a_us, b) && near(known.link.b, known.utime_b_us, a));
  });
}

// Adds the link as found, with the unconfirmed link that agrees with it, if there is one; otherwise as unconfirmed.
void PlaceSearch::take(LinkEdge edge, double median_depth, const Submaps& submaps, PlaceLinks* links) const {
  std::vector<LinkEdge>& unconfirmed = links->unconfirmed;
  const auto confirms = [&](const LinkEdge& other) { return agree(edge, median_depth, other, submaps); };
  const auto other = std::find_if(unconfirmed.begin(), unconfirmed.end(), confirms);
  if (other == unconfirmed.end()) {
    unconfirmed.push_back(std::move(edge));
    if (unconfirmed.size() > kMostUnconfirmed) unconfirmed.erase(unconfirmed.begin());
    return;
  }
  links->found.push_back(std::move(*other));
  links->found.push_back(std::move(edge));
  unconfirmed.erase(other);
}

// True if two links confirm each other. `median_depth`: of the landmarks of x, in the unit of x.b.
bool PlaceSearch::agree(const LinkEdge& x, double median_depth, const LinkEdge& other, const Submaps& submaps) const {
  const bool same_order = x.link.a == other.link.a && x.link.b == other.link.b;
  if (!same_order && !(x.link.a == other.link.b && x.link.b == other.link.a)) return false;
  // If both links are loops of one submap, compares those ends that are nearer to each other in time.
  const bool turn = !same_order || (x.link.a == x.link.b && std::abs(x.utime_a_us - other.utime_a_us) >
                                                                std::abs(x.utime_a_us - other.utime_b_us));
  const LinkEdge y = turn ? turned(other) : other;
  const double within_us = o_.confirm_within_s * 1e6;
  if (static_cast<double>(std::abs(x.utime_a_us - y.utime_a_us)) > within_us ||
      static_cast<double>(std::abs(x.utime_b_us - y.utime_b_us)) > within_us ||
      (x.utime_a_us == y.utime_a_us && x.utime_b_us == y.utime_b_us))
    return false;
  if (std::abs(std::log(x.link.b_from_a.scale / y.link.b_from_a.scale)) > o_.confirm_log_scale) return false;
  const double angle = x.link.b_from_a.rotation.angularDistance(y.link.b_from_a.rotation);
  if (angle > o_.confirm_rotation_deg * M_PI / 180) return false;
  // Compares the positions of the camera, which may be far from the origin of both submaps.
  const Submap& a = *submaps.at(x.link.a);
  const auto frame = a.frame(x.utime_a_us);
  if (!frame) return false;
  const Eigen::Vector3d center = a.cam_from_submap(*frame).center();
  return (x.link.b_from_a * center - y.link.b_from_a * center).norm() <= o_.confirm_translation * median_depth;
}

void PlaceSearch::search(const Place& place, const Submaps& submaps, const Joined& joined, PlaceLinks* links) const {
  const Submap& submap = *submaps.at(place.submap);
  const auto surroundings = exclude_surroundings(submap, place.keyframe, static_cast<int64_t>(o_.min_apart_s * 1e6));
  const auto exclude = [&](const Place& other) {
    return surroundings(other) || is_known(links->found, place, other) || joined(place, other);
  };
  const std::vector<PlaceCandidate> candidates =
      index_.query(landmark_descriptors(*submap.keyframe(place.keyframe)), static_cast<size_t>(o_.candidates),
                   static_cast<int64_t>(o_.separation_s * 1e6), exclude);
  for (const PlaceCandidate& candidate : candidates) {
    const Place& other = candidate.place;
    // Most pairs of unrelated places are refused here, at a tenth of the cost of an alignment.
    if (alike(submap, place.keyframe, *submaps.at(other.submap), other.keyframe, o_.alignment.matching) < o_.min_alike)
      continue;
    const PlaceAlignment alignment =
        align_places(submap, place.keyframe, *submaps.at(other.submap), other.keyframe, o_.alignment);
    if (alignment.doubt.empty()) {
      take(make_edge(place, other, submaps, o_, alignment), alignment.median_depth, submaps, links);
      return;
    }
    // Does not report links without any inlier.
    if (place.submap != other.submap && alignment.inliers > 0)
      links->refused[std::minmax(place.submap, other.submap)] = make_link(place, other, alignment);
  }
}

}  // namespace rumi::map_server
