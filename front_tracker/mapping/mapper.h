// SPDX-License-Identifier: BSD-3-Clause
// Maps a new keyframe: makes landmarks by triangulation, fuses duplicates, adjusts the neighbourhood, and culls.
#pragma once

#include <mutex>
#include <optional>

#include "front_tracker/frame/front_submap.h"
#include "front_tracker/mapping/mapping_options.h"

namespace rumi::front_tracker {

class Mapper {
 public:
  Mapper(const Camera& camera, const MappingOptions& options);

  // `mutex` guards the submap. It is locked in the short steps, but not while the bundle adjustment is solved.
  void process(FrontSubmap& submap, int keyframe_id, std::mutex& mutex) const;

 private:
  void cull_landmarks(FrontSubmap& submap, int keyframe_id) const;
  void make_landmarks(FrontSubmap& submap, int keyframe_id) const;
  // `known`: true for keypoints of the keyframe that get no landmark.
  void make_landmarks_between(FrontSubmap& submap, Keyframe& keyframe, Keyframe& neighbour,
                              const std::vector<char>& known) const;
  std::optional<Eigen::Vector3d> triangulate_between(const FrontSubmap& submap, const Keyframe& a, int keypoint_a,
                                                     const Keyframe& b, int keypoint_b) const;
  void fuse_landmarks(FrontSubmap& submap, int keyframe_id) const;
  void fuse_into(FrontSubmap& submap, const std::vector<int>& landmark_ids, int keyframe_id) const;
  void cull_keyframes(FrontSubmap& submap, int keyframe_id) const;
  Camera camera_;
  MappingOptions options_;
};

}  // namespace rumi::front_tracker
