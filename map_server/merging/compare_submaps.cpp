// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/merging/compare_submaps.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "map_server/alignment/correspondences.h"

namespace rumi::map_server {

namespace {

// Returns the joint at one common image. Returns nullopt if the image does not determine the scale between the submaps.
std::optional<KeyframeJoint> make_joint(const Submap& a, const Submap& b, const Correspondences& common, int k,
                                        const PairOptions& options) {
  const SharedKeyframe& shared = common.keyframes[k];
  const ScaleRatio ratio = scale_ratio(a, b, common, k, options.alignment.min_landmarks / 4);
  if (!std::isfinite(ratio.sigma)) return std::nullopt;
  return KeyframeJoint{{a.key, shared.a},
                       {b.key, shared.b},
                       Sim3(std::exp(ratio.log_b_over_a), Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero()),
                       options.joint_sigma_rotation_deg * M_PI / 180,
                       options.joint_sigma_translation * ratio.depth_b,
                       std::max(ratio.sigma, options.joint_sigma_log_scale)};
}

// Returns the last revision in which the keyframe or a landmark that it observes changed.
int64_t last_change(const Submap& submap, const Keyframe& keyframe) {
  int64_t revision = keyframe.revision;
  for (const int id : keyframe.landmark_ids)
    if (const Landmark* landmark = id == kNone ? nullptr : submap.landmark(id))
      revision = std::max(revision, landmark->revision);
  return revision;
}

}  // namespace

SharedState shared_state(const Submap& a, const Submap& b) {
  SharedState state;
  for (const SharedKeyframe& shared : shared_keyframes(a, b)) {
    ++state.keyframes;
    state.revision_a = std::max(state.revision_a, last_change(a, *a.keyframe(shared.a)));
    state.revision_b = std::max(state.revision_b, last_change(b, *b.keyframe(shared.b)));
  }
  return state;
}

ComparedPair compare_submaps(const Submap& a, const Submap& b, const PairOptions& options) {
  ComparedPair pair{.revision_a = a.revision, .revision_b = b.revision, .edge = std::nullopt};
  const Correspondences common = find_correspondences(a, b);
  if (common.keyframes.empty()) return pair;
  const Alignment alignment = align_submaps(a, b, common, options.alignment);
  LinkEdge& edge = pair.edge.emplace();
  edge.link = {.a = a.key,
               .b = b.key,
               .kind = Link::Kind::kSameImages,
               .b_from_a = alignment.b_from_a,
               .keyframes = alignment.keyframes,
               .keyframe_inliers = alignment.keyframe_inliers,
               .landmarks = alignment.landmarks,
               .landmark_inliers = alignment.landmark_inliers,
               .rmse_px = alignment.rmse_px,
               .doubt = alignment.doubt};
  if (!edge.link.accepted()) return pair;
  std::vector<int64_t> where;
  for (size_t k = 0; k < common.keyframes.size(); ++k) {
    if (!alignment.keyframe_inlier[k]) continue;  // one of the submaps is bent there
    where.push_back(common.keyframes[k].utime_us);
    if (const auto joint = make_joint(a, b, common, static_cast<int>(k), options)) edge.joints.push_back(*joint);
  }
  edge.utime_a_us = edge.utime_b_us = where[where.size() / 2];
  return pair;
}

}  // namespace rumi::map_server
