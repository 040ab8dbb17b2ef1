// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/model/map_graph.h"

#include <algorithm>
#include <cmath>

#include "slam/map/landmark_view.h"
#include "slam/optimization/graduated_sim3_graph.h"

namespace rumi::map_server {
namespace {

using Placed = std::map<SubmapKey, PlacedSubmap>;

// By this factor the relative pose of two keyframes is less certain if the submap slipped between them: landmarks that
// were tracked wrong say next to nothing.
constexpr double kAcrossSlip = 30;

class Bender {
 public:
  Bender(const MapGraphOptions& options, SubmapKey anchor, Placed* submaps) : o_(options), submaps_(*submaps) {
    for (const auto& [key, placed] : submaps_)
      for (const auto& [id, keyframe] : placed.submap->keyframes) {
        node_[{key, id}] = static_cast<int>(graph_.nodes.size());
        graph_.nodes.push_back(
            {placed.placement.at(keyframe.utime_us) * Sim3(keyframe.cam_from_submap.inverse()), placed.fixed});
      }
    const Submap& first = *submaps_.at(anchor).submap;
    if (!first.keyframes.empty()) graph_.nodes[node_.at({anchor, first.keyframes.begin()->first})].fixed = true;
  }

  MapGraphReport run(const std::vector<LinkJoints>& links, const std::function<bool(size_t)>& may_be_wrong) {
    std::vector<KeyframeJoint> all;
    for (const LinkJoints& joints : links) all.insert(all.end(), joints.begin(), joints.end());
    report_.slips = find_slips(all, submaps_);
    for (const auto& [key, placed] : submaps_)
      if (!placed.fixed) add_submap(key, *placed.submap);
    std::vector<std::vector<int>> edges;
    edges.reserve(links.size());
    for (const LinkJoints& joints : links) edges.push_back(add_joints(joints));
    const GraduatedReport solved = solve_graduated({{}, o_.max_joint_chi2}, edges, may_be_wrong, &graph_);
    report_.bent = solved.solved.usable;
    if (!report_.bent) return report_;
    for (const std::vector<int>& of_link : edges) {
      std::vector<double>& chi2 = report_.joint_chi2.emplace_back();
      for (const int edge : of_link) chi2.push_back(solved.solved.edge_chi2[edge]);
    }
    report_.is_wrong = solved.is_wrong;
    apply();
    return report_;
  }

 private:
  std::vector<int> add_joints(const LinkJoints& joints) {
    std::vector<int> edges;
    for (const KeyframeJoint& joint : joints) {
      edges.push_back(static_cast<int>(graph_.edges.size()));
      graph_.edges.push_back({node_.at({joint.a.submap, joint.a.id}), node_.at({joint.b.submap, joint.b.id}),
                              joint.b_from_a, joint.sigma_rotation_rad, joint.sigma_translation, joint.sigma_log_scale,
                              Eigen::Vector3d::Zero()});
    }
    return edges;
  }

  void add_submap(SubmapKey key, const Submap& submap) {
    std::map<std::pair<int, int>, int> shared;  // number of landmarks in common, by pairs of keyframes
    for (auto it = submap.keyframes.begin(); it != submap.keyframes.end(); ++it) {
      if (const auto next = std::next(it); next != submap.keyframes.end()) shared[{it->first, next->first}] = 1;
      int added = 0;
      for (const auto& [other, count] : submap.covisible_keyframes(it->first)) {
        if (count < o_.min_shared_landmarks || ++added > o_.neighbours) break;
        shared[std::minmax(it->first, other)] = count;
      }
    }
    for (const auto& [pair, count] : shared)
      add_edge(key, submap, submap.keyframes.at(pair.first), submap.keyframes.at(pair.second), count);
  }

  void add_edge(SubmapKey key, const Submap& submap, const Keyframe& a, const Keyframe& b, int shared) {
    const SE3 b_from_a = b.cam_from_submap * a.cam_from_submap.inverse();
    const double depth = std::max(median_depth(submap, b.cam_from_submap, b.landmark_ids), 1e-6);
    double weaker = std::sqrt(100.0 / shared);
    if (is_across_slip(key, a.id, b.id)) weaker *= kAcrossSlip;
    graph_.edges.push_back({node_.at({key, a.id}), node_.at({key, b.id}), Sim3(b_from_a),
                            weaker * o_.sigma_rotation_deg * M_PI / 180, weaker * o_.sigma_translation * depth,
                            weaker * o_.sigma_log_scale, b_from_a.inverse() * Eigen::Vector3d(0, 0, depth)});
  }

  bool is_across_slip(SubmapKey key, int a, int b) const {
    return std::any_of(report_.slips.begin(), report_.slips.end(),
                       [&](const Slip& slip) { return slip.submap == key && slip.is_between(a, b); });
  }

  void apply() {
    for (auto& [key, placed] : submaps_) {
      if (placed.fixed) continue;
      const Placement before = placed.placement;
      for (const auto& [id, keyframe] : placed.submap->keyframes)
        placed.placement.map_from_submap[keyframe.utime_us] =
            graph_.nodes[node_.at({key, id})].map_from_node * Sim3(keyframe.cam_from_submap);
      placed.placement.landmarks.clear();
      for (const auto& [id, position] : before.landmarks) {
        const Landmark* landmark = placed.submap->landmark(id);
        const Keyframe* host = landmark ? host_of(*placed.submap, *landmark) : nullptr;
        if (!host) continue;
        const int64_t at_us = host->utime_us;
        placed.placement.landmarks[id] = placed.placement.at(at_us) * (before.at(at_us).inverse() * position);
      }
    }
  }

  const MapGraphOptions& o_;
  Placed& submaps_;
  Sim3Graph graph_;
  std::map<std::pair<SubmapKey, int>, int> node_;
  MapGraphReport report_;
};

}  // namespace

MapGraphReport bend(const std::vector<LinkJoints>& links, const std::function<bool(size_t)>& may_be_wrong,
                    SubmapKey anchor, const MapGraphOptions& options, Placed* submaps) {
  return Bender(options, anchor, submaps).run(links, may_be_wrong);
}

}  // namespace rumi::map_server
