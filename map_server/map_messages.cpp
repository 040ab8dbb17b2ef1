// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/map_messages.h"

#include <algorithm>
#include <cstring>

#include "bus/wire/pose.h"

namespace rumi::map_server {
namespace {

// Uses stableNorm because a requester may send any number.
bool is_within(const Eigen::Vector3d& position, const map_region_t& region) {
  return (position - Eigen::Vector3d(region.center)).stableNorm() <= region.radius;
}

void add_submap(const Atlas& atlas, const AtlasSubmap& owner, map_region_t* region) {
  const SubmapKey key = owner.submap.key;
  for (const auto& [id, landmark] : owner.submap.landmarks) {
    const Eigen::Vector3d position = owner.placement.position_in_map(owner.submap, landmark);
    if (!is_within(position, *region) || !atlas.stands_for_itself(owner, id)) continue;
    region_landmark_t& wire = region->landmarks.emplace_back();
    wire.session = key.session, wire.submap_id = key.id, wire.id = id;
    std::copy_n(position.data(), 3, wire.position);
    std::memcpy(wire.descriptor, landmark.descriptor.data(), sizeof(Descriptor));
  }
  for (const auto& [id, keyframe] : owner.submap.keyframes) {
    const SE3 map_from_cam = owner.placement.cam_from_map(keyframe).inverse();
    if (!is_within(map_from_cam.translation, *region)) continue;
    region_keyframe_t& wire = region->keyframes.emplace_back();
    wire.session = key.session, wire.submap_id = key.id, wire.id = id;
    wire.utime = keyframe.utime_us;
    wire.map_from_cam = to_wire(map_from_cam);
  }
}

}  // namespace

trajectory_t make_trajectory(const Atlas& atlas, int64_t utime_us) {
  trajectory_t message{};
  message.utime = utime_us;
  message.map_revision = atlas.revision();
  for (const auto& [image, map_from_cam] : atlas.map_trajectory()) {
    message.frame_utime.push_back(image.utime_us);
    message.frame_stream.push_back(image.stream);
    message.map_from_cam.push_back(to_wire(map_from_cam));
    const PoseSigmas sigmas = atlas.locate(image)->sigmas();
    message.position_sigma.push_back(sigmas.position);
    message.rotation_sigma_rad.push_back(sigmas.rotation_rad);
    message.log_scale_sigma.push_back(sigmas.log_scale);
  }
  message.n = static_cast<int32_t>(message.frame_utime.size());
  return message;
}

map_region_t make_map_region(const Atlas& atlas, const Eigen::Vector3d& center, double radius, int64_t utime_us) {
  map_region_t region{};
  region.utime = utime_us;
  region.map_revision = atlas.revision();
  std::copy_n(center.data(), 3, region.center);
  region.radius = radius;
  for (const auto& [key, owner] : atlas.submaps())
    if (owner.in_map) add_submap(atlas, owner, &region);
  region.nlandmarks = static_cast<int32_t>(region.landmarks.size());
  region.nkeyframes = static_cast<int32_t>(region.keyframes.size());
  return region;
}

}  // namespace rumi::map_server
