// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/model/slips.h"

#include <cmath>
#include <optional>

#include "slam/map/landmark_view.h"

namespace rumi::map_server {
namespace {

// A smaller change of the log scale may be the error of the joint: two alignments of a place that differ by as much
// still confirm each other (PlaceSearchOptions). After a larger one than kMostChange hardly a landmark is tracked on,
// so the joint is wrong.
constexpr double kLeastChange = 0.15, kMostChange = 0.7;
constexpr double kMaxJump = 0.5;  // of the camera at the slip, as a share of the median depth

double change_of_scale(const KeyframeJoint& joint) { return std::abs(std::log(joint.b_from_a.scale)); }

std::vector<KeyframeJoint> within(SubmapKey submap, const std::vector<KeyframeJoint>& joints) {
  std::vector<KeyframeJoint> inner;
  for (const KeyframeJoint& joint : joints)
    if (joint.a.submap == submap && joint.b.submap == submap) inner.push_back(joint);
  return inner;
}

// Returns by keyframe the number of landmarks that are seen both until then and afterwards.
std::map<int, int> landmarks_across(const Submap& submap) {
  std::map<int, int> change;
  for (const auto& [id, landmark] : submap.landmarks) {
    if (landmark.observations.empty()) continue;
    ++change[landmark.observations.front().keyframe_id];
    --change[landmark.observations.back().keyframe_id];
  }
  std::map<int, int> across;
  int open = 0;
  for (const auto& [id, keyframe] : submap.keyframes) across[id] = open += change[id];
  return across;
}

// Returns the keyframe before the slip that `joint` tells of. `joints`: all within the submap.
std::optional<Slip> place_slip(const Submap& submap, const KeyframeJoint& joint,
                               const std::vector<KeyframeJoint>& joints) {
  const Keyframe *a = submap.keyframe(joint.a.id), *b = submap.keyframe(joint.b.id);
  // Brings what lies on the side of a to where it lies as seen from the side of b.
  const Sim3 b_side_from_a_side = Sim3(b->cam_from_submap.inverse()) * joint.b_from_a * Sim3(a->cam_from_submap);
  const std::map<int, int> across = landmarks_across(submap);
  std::optional<Slip> best;
  for (const auto& [id, keyframe] : submap.keyframes) {
    const Slip here{submap.key, id};
    if (!here.is_between(a->id, b->id) || (best && across.at(id) >= across.at(best->keyframe))) continue;
    const Eigen::Vector3d center = keyframe.cam_from_submap.center();
    const double depth = median_depth(submap, keyframe.cam_from_submap, keyframe.landmark_ids);
    const bool jumps = (b_side_from_a_side * center - center).norm() > kMaxJump * depth;
    const bool is_denied = std::any_of(joints.begin(), joints.end(), [&](const KeyframeJoint& other) {
      return here.is_between(other.a.id, other.b.id) && change_of_scale(other) <= kLeastChange;
    });
    if (!jumps && !is_denied) best = here;
  }
  return best;
}

}  // namespace

std::vector<Slip> find_slips(const std::vector<KeyframeJoint>& joints,
                             const std::map<SubmapKey, PlacedSubmap>& submaps) {
  std::vector<Slip> slips;
  for (const auto& [key, placed] : submaps) {
    if (placed.fixed) continue;
    const std::vector<KeyframeJoint> inner = within(key, joints);
    const size_t before = slips.size();
    for (const KeyframeJoint& joint : inner) {
      const double change = change_of_scale(joint);
      if (!(change > kLeastChange && change < kMostChange)) continue;
      const bool is_told = std::any_of(slips.begin() + static_cast<long>(before), slips.end(),
                                       [&](const Slip& slip) { return slip.is_between(joint.a.id, joint.b.id); });
      if (is_told) continue;
      if (const std::optional<Slip> slip = place_slip(*placed.submap, joint, inner)) slips.push_back(*slip);
    }
  }
  return slips;
}

}  // namespace rumi::map_server
