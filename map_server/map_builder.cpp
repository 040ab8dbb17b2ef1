// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/map_builder.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace rumi {
namespace {

bool may_share_images(const Submap& a, const Submap& b) {
  return !a.frames.empty() && !b.frames.empty() && a.frames.begin()->first <= b.frames.rbegin()->first &&
         b.frames.begin()->first <= a.frames.rbegin()->first;
}

// The same similarity at every keyframe.
Placement rigid(const Submap& submap, const Sim3& map_from_submap) {
  Placement placement;
  for (const auto& [id, keyframe] : submap.keyframes) placement.map_from_submap[keyframe.utime_us] = map_from_submap;
  return placement;
}

// Groups of submaps that hang together.
class Groups {
 public:
  void unite(SubmapKey a, SubmapKey b) { parent_[find(a)] = find(b); }
  SubmapKey find(SubmapKey key) {
    const SubmapKey up = parent_.try_emplace(key, key).first->second;
    return up == key ? key : parent_[key] = find(up);
  }

 private:
  std::map<SubmapKey, SubmapKey> parent_;
};

// An adjustment leaves the map's unit and place open: the anchor's first keyframe stays where it was.
void keep_gauge(const PlacedSubmap& anchor_before, SubmapKey anchor, std::map<SubmapKey, Placement>* placements) {
  const int64_t first_us = anchor_before.submap->frames.begin()->first;
  const Sim3 before_from_after = anchor_before.placement.at(first_us) * placements->at(anchor).at(first_us).inverse();
  for (auto& [key, placement] : *placements) {
    for (auto& [utime_us, map_from_submap] : placement.map_from_submap)
      map_from_submap = before_from_after * map_from_submap;
    for (auto& [id, position] : placement.landmarks) position = before_from_after * position;
  }
}

}  // namespace

MapBuilder::Pair MapBuilder::compare(const Submap& a, const Submap& b) const {
  Pair pair{a.revision, b.revision, {}, {}};
  if (!may_share_images(a, b)) return pair;
  const Correspondences common = find_correspondences(a, b, options_.alignment.max_pixel_distance_px);
  if (common.keyframes.empty()) return pair;
  const Alignment alignment = align_submaps(a, b, common, options_.alignment);
  pair.link = Link{.a = a.key,
                   .b = b.key,
                   .kind = Link::Kind::kSameImages,
                   .b_from_a = alignment.b_from_a,
                   .keyframes = alignment.keyframes,
                   .keyframe_inliers = alignment.keyframe_inliers,
                   .landmarks = alignment.landmarks,
                   .landmark_inliers = alignment.landmark_inliers,
                   .rmse_px = alignment.rmse_px,
                   .doubt = alignment.doubt};
  for (size_t k = 0; k < common.keyframes.size(); ++k) {
    const SharedKeyframe& shared = common.keyframes[k];
    const ScaleRatio ratio = scale_ratio(a, b, common, static_cast<int>(k), options_.alignment.min_landmarks / 4);
    if (!std::isfinite(ratio.sigma)) continue;
    pair.images.push_back(shared.utime_us);
    // One camera, in the units of two submaps.
    pair.joints.push_back({{a.key, shared.a},
                           {b.key, shared.b},
                           Sim3(std::exp(ratio.log_b_over_a), Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero()),
                           options_.joint_sigma_rotation_deg * M_PI / 180,
                           options_.joint_sigma_translation * ratio.depth_b,
                           std::max(ratio.sigma, options_.joint_sigma_log_scale)});
  }
  return pair;
}

void MapBuilder::find_links(const Submaps& submaps) {
  for (auto a = submaps.begin(); a != submaps.end(); ++a)
    for (auto b = std::next(a); b != submaps.end(); ++b) {
      Pair& pair = pairs_[{a->first, b->first}];
      if (pair.revision_a == a->second->revision && pair.revision_b == b->second->revision) continue;
      pair = compare(*a->second, *b->second);
    }
}

std::vector<Link> MapBuilder::links() const {
  std::vector<Link> links;
  for (const auto& [keys, pair] : pairs_)
    if (pair.link) links.push_back(*pair.link);
  return links;
}

std::set<SubmapKey> MapBuilder::choose_members(const Submaps& submaps,
                                               const std::map<SubmapKey, Placement>& placed) const {
  Groups groups;
  for (const auto& [keys, pair] : pairs_)
    if (pair.link && pair.link->accepted()) groups.unite(keys.first, keys.second);
  for (const auto& [key, placement] : placed) groups.unite(key, placed.begin()->first);
  std::map<SubmapKey, std::set<int64_t>> frames;  // by group, of those with a front submap
  for (const auto& [key, submap] : submaps)
    if (submap->kind == SubmapKind::kFront) frames[groups.find(key)];
  for (const auto& [key, submap] : submaps) {
    const auto group = frames.find(groups.find(key));
    if (group == frames.end()) continue;
    for (const auto& [utime_us, frame] : submap->frames) group->second.insert(utime_us);
  }
  const auto largest = std::max_element(frames.begin(), frames.end(),
                                        [](const auto& x, const auto& y) { return x.second.size() < y.second.size(); });
  std::set<SubmapKey> members;
  if (largest == frames.end()) return members;
  for (const auto& [key, submap] : submaps)
    if (groups.find(key) == largest->first) members.insert(key);
  return members;
}

SubmapKey MapBuilder::choose_anchor(const Submaps& submaps, const std::set<SubmapKey>& members,
                                    const std::map<SubmapKey, Placement>& placed) const {
  SubmapKey anchor;
  size_t most = 0;
  for (const SubmapKey& key : members) {
    const Submap& submap = *submaps.at(key);
    if (submap.kind != SubmapKind::kFront || submap.frames.empty()) continue;
    if (placed.contains(key)) return key;
    if (submap.frames.size() <= most) continue;
    most = submap.frames.size();
    anchor = key;
  }
  return anchor;
}

// One after another, over the link with most inliers each time.
MapBuilder::Placed MapBuilder::place_members(const Submaps& submaps, const std::set<SubmapKey>& members,
                                             SubmapKey anchor, const std::map<SubmapKey, Placement>& placed) const {
  Placed result;
  for (const auto& [key, placement] : placed)
    if (members.contains(key)) result[key] = {submaps.at(key), placement};
  if (!result.contains(anchor)) result[anchor] = {submaps.at(anchor), rigid(*submaps.at(anchor), {})};
  for (;;) {
    const Pair* best = nullptr;
    for (const auto& [keys, pair] : pairs_) {
      if (!pair.link || !pair.link->accepted() || !members.contains(keys.first)) continue;
      if (result.contains(keys.first) == result.contains(keys.second)) continue;
      if (!best || pair.link->landmark_inliers > best->link->landmark_inliers) best = &pair;
    }
    if (!best) return result;
    const bool a_is_placed = result.contains(best->link->a);
    const SubmapKey from = a_is_placed ? best->link->a : best->link->b;
    const SubmapKey to = a_is_placed ? best->link->b : best->link->a;
    const Sim3 from_from_to = a_is_placed ? best->link->b_from_a.inverse() : best->link->b_from_a;
    const Sim3 map_from_neighbour = result.at(from).placement.at(best->images[best->images.size() / 2]);
    result[to] = {submaps.at(to), rigid(*submaps.at(to), map_from_neighbour * from_from_to)};
  }
}

BuiltMap MapBuilder::build(const Submaps& submaps, const std::map<SubmapKey, Placement>& placed) const {
  const std::set<SubmapKey> members = choose_members(submaps, placed);
  BuiltMap built;
  if (members.size() < 2) return built;
  const SubmapKey anchor = choose_anchor(submaps, members, placed);
  Placed before = place_members(submaps, members, anchor, placed);
  std::vector<KeyframeJoint> joints;
  for (const auto& [keys, pair] : pairs_)
    if (pair.link && pair.link->accepted() && members.contains(keys.first))
      joints.insert(joints.end(), pair.joints.begin(), pair.joints.end());
  bend(joints, anchor, options_.graph, &before);
  MapModel model = join(before, options_.alignment.max_pixel_distance_px);
  MapBundleReport bundle = adjust_map({}, options_.bundle, &model);
  AssociationOptions association = options_.association;
  for (int round = 0; round < options_.association_rounds; ++round, association.radius_px /= 2) {
    const AssociationReport found = associate(association, &model);
    built.report.observed += found.observed;
    built.report.fused += found.fused;
    bundle = adjust_map({}, options_.bundle, &model);
  }
  built.report.views = bundle.views;
  built.report.points = bundle.points;
  built.report.observations = bundle.observations;
  built.report.outliers = bundle.outliers;
  built.report.rmse = bundle.rmse;
  built.placements = split(model, before);
  keep_gauge(before.at(anchor), anchor, &built.placements);
  return built;
}

}  // namespace rumi
