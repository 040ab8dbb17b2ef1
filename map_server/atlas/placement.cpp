// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/atlas/placement.h"

#include <algorithm>
#include <iterator>

namespace rumi::map_server {

const Keyframe* host_of(const Submap& submap, const Landmark& landmark) {
  return landmark.observations.empty() ? nullptr : submap.keyframe(landmark.observations.front().keyframe_id);
}

Sim3 Placement::at(int64_t utime_us) const {
  if (map_from_submap.empty()) return {};
  const auto after = map_from_submap.lower_bound(utime_us);
  if (after == map_from_submap.end()) return latest();
  if (after == map_from_submap.begin()) return after->second;
  const auto before = std::prev(after);
  return utime_us - before->first <= after->first - utime_us ? before->second : after->second;
}

SE3 Placement::cam_from_map(const Keyframe& keyframe) const {
  return at(keyframe.utime_us).transform_camera(keyframe.cam_from_submap);
}

Sim3 Placement::at(const Submap& submap, const FramePose& frame) const {
  const Keyframe* reference = submap.keyframe(frame.reference_keyframe);
  return at(reference ? reference->utime_us : frame.utime_us);
}

SE3 Placement::cam_from_map(const Submap& submap, const FramePose& frame) const {
  return at(submap, frame).transform_camera(submap.cam_from_submap(frame));
}

Eigen::Vector3d Placement::position_in_map(const Submap& submap, const Landmark& landmark) const {
  if (const auto adjusted = landmarks.find(landmark.id); adjusted != landmarks.end()) return adjusted->second;
  const Keyframe* host = host_of(submap, landmark);
  return (host ? at(host->utime_us) : latest()) * landmark.position;
}

bool same_place(const Placement& a, const Placement& b) {
  const auto same_similarity = [](const auto& x, const auto& y) {
    return x.first == y.first && x.second.scale == y.second.scale &&
           x.second.rotation.coeffs() == y.second.rotation.coeffs() && x.second.translation == y.second.translation;
  };
  return std::equal(a.map_from_submap.begin(), a.map_from_submap.end(), b.map_from_submap.begin(),
                    b.map_from_submap.end(), same_similarity) &&
         a.landmarks == b.landmarks && a.fused == b.fused;
}

Submap place(const Submap& submap, const Placement& placement) {
  Submap placed = submap;
  if (placement.map_from_submap.empty() && placement.landmarks.empty()) return placed;  // unchanged to the last bit
  for (auto& [id, keyframe] : placed.keyframes)
    keyframe.cam_from_submap = placement.cam_from_map(submap.keyframes.at(id));
  for (auto& [id, landmark] : placed.landmarks)
    landmark.position = placement.position_in_map(submap, submap.landmarks.at(id));
  placed.frames.change_all([&](FramePose* frame) {
    const double scale = placement.at(submap, *frame).scale;
    frame->cam_from_keyframe.translation *= scale;
    frame->sigmas = scaled(frame->sigmas, scale);
  });
  return placed;
}

}  // namespace rumi::map_server
