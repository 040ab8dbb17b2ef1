// SPDX-License-Identifier: BSD-3-Clause
// Submap <-> wire. What travels is what changed since a revision; see lcmtypes/submap.lcm.
#pragma once

#include <string>

#include "lcmtypes/rumi/rigid_t.hpp"
#include "lcmtypes/rumi/rigid_transform_t.hpp"
#include "lcmtypes/rumi/similarity_t.hpp"
#include "lcmtypes/rumi/submap_update_t.hpp"
#include "slam/map/submap.h"

namespace rumi {

// Everything in the submap that changed after base_revision (0: all of it; also where the submap no longer remembers
// all that was removed since: then the update's own base_revision is 0).
submap_update_t make_submap_update(const Submap& submap, int64_t base_revision);

// Brings the submap (empty, or an earlier revision of the same one) to update.revision; an update with base_revision 0
// replaces what it holds. Returns what is wrong, with
// field and value, and leaves the submap untouched, if: keys differ; base_revision is beyond the submap's revision; a
// number is not finite; a count, index or id does not fit; the calibration is bad. An update that is not newer is no
// error and changes nothing.
std::string apply_submap_update(const submap_update_t& update, Submap* submap);

rigid_t to_wire(const SE3& pose);
similarity_t to_wire(const Sim3& similarity);
rigid_transform_t to_wire(int64_t utime, const SE3& pose);
// Into the members of that name of a track_t or a frame_t, and out of them; not known is what pose_sigmas() says.
template <class Wire>
void put_sigmas(const PoseSigmas& sigmas, Wire* wire) {
  wire->position_sigma = sigmas.position;
  wire->rotation_sigma_rad = sigmas.rotation_rad;
  wire->log_scale_sigma = sigmas.log_scale;
}
template <class Wire>
PoseSigmas sigmas_of(const Wire& wire) {
  return pose_sigmas(static_cast<double>(wire.position_sigma), static_cast<double>(wire.rotation_sigma_rad),
                     static_cast<double>(wire.log_scale_sigma));
}
// Nothing if not finite or the quaternion is not of unit length within 1e-3.
std::optional<SE3> from_wire(const rigid_t& pose);
std::optional<Sim3> from_wire(const similarity_t& similarity);

}  // namespace rumi
