// SPDX-License-Identifier: BSD-3-Clause
// Where a landmark appears in an image, by the patch around it in the first keyframes that saw it, as far as their
// images are kept (FrontSubmap::images).
#pragma once

#include <optional>
#include <vector>

#include "front_tracker/frame/front_submap.h"
#include "front_tracker/patches/patch_templates.h"

namespace rumi::front_tracker {

// One view of a landmark: the camera's pose, and its image.
struct ImagedView {
  const SE3& cam_from_submap;
  const ImagePyramid& images;
};

// The keypoint in the view, within two pixels of at.pixel in the level at.octave, where it looks as in the first of the
// submap's observations `references` of the landmark at `position` whose images are kept; the view's own is none of
// them. Its direction is that of the observation, turned with the patch. The surface is taken to be parallel to the
// reference's image plane. Nothing if two of them are not found.
std::optional<Keypoint> find_patch(const FrontSubmap& submap, const Eigen::Vector3d& position,
                                   const std::vector<Observation>& references, const ImagedView& view,
                                   const Keypoint& at, PatchTemplates* templates);

// Far enough from the border of its level for a keypoint (kOrbBorder_px), and from what the image's mask leaves out.
bool is_inside(const ImagePyramid& images, const Keypoint& keypoint);

// A keypoint of the landmark that no corner was found for, with the descriptor of its latest observation.
void add_keypoint(const Submap& map, const Landmark& landmark, const ImagePyramid& images, const Keypoint& keypoint,
                  Features* features);

}  // namespace rumi::front_tracker
