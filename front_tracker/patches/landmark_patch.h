// SPDX-License-Identifier: BSD-3-Clause
// Finds a landmark in an image by comparing patches: that of the image, and those around the landmark in the first
// keyframes that observed it, if their images are kept (FrontSubmap::images).
#pragma once

#include <optional>
#include <vector>

#include "front_tracker/frame/front_submap.h"
#include "front_tracker/patches/patch_templates.h"

namespace rumi::front_tracker {

// A view of a landmark: the camera's pose and its image.
struct ImagedView {
  const SE3& cam_from_submap;
  const ImagePyramid& images;
};

// Looks for the landmark at `position` within two pixels of at.pixel in the level at.octave. `references` are the
// landmark's observations in the submap, without one by this view. The first two whose images are kept are tried.
// The surface is assumed to be parallel to the reference's image plane. Returns the keypoint, with the reference's
// angle turned as the patch is; nullopt if neither reference is found.
std::optional<Keypoint> find_patch(const FrontSubmap& submap, const Eigen::Vector3d& position,
                                   const std::vector<Observation>& references, const ImagedView& view,
                                   const Keypoint& at, PatchTemplates* templates);

// True if the keypoint is far enough from the border of its level (kOrbBorder_px) and from pixels that the mask leaves
// out.
bool is_inside(const ImagePyramid& images, const Keypoint& keypoint);

// Adds a keypoint for a landmark that was found by its patch, with the descriptor of the landmark's latest observation.
void add_keypoint(const Submap& map, const Landmark& landmark, const ImagePyramid& images, const Keypoint& keypoint,
                  Features* features);

}  // namespace rumi::front_tracker
