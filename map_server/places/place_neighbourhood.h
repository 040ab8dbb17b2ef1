// SPDX-License-Identifier: BSD-3-Clause
// A place of a submap: a keyframe, the keyframes that see most of the same landmarks, and those landmarks.
#pragma once

#include <string>
#include <vector>

#include "slam/features/keypoint_grid.h"
#include "slam/map/submap.h"

namespace rumi::map_server {

// A keyframe ready to be searched.
struct PlaceView {
  const Keyframe* keyframe = nullptr;
  std::vector<int> known;           // keypoints that observe a landmark of the neighbourhood, ascending
  std::vector<int> landmark_index;  // per keypoint, into PlaceNeighbourhood::landmarks, or kNone
  KeypointGrid grid;                // of all keypoints, undistorted
};

struct PlaceSighting {
  int view = kNone;  // index into PlaceNeighbourhood::views
  int keypoint = kNone;
};

struct PlaceLandmark {
  int id = kNone;
  Eigen::Vector3d position;              // in the submap; finite
  std::vector<PlaceSighting> sightings;  // at least one
};

struct PlaceNeighbourhood {
  const Submap* submap = nullptr;
  std::vector<PlaceView> views;          // the views that an alignment uses; the keyframe itself comes first
  std::vector<PlaceView> witnesses;      // covisible keyframes that no alignment uses, so that they can verify it
  std::vector<PlaceLandmark> landmarks;  // that the views observe, ascending id

  const Features& features(int view) const { return *views[view].keyframe->features; }
  Eigen::Vector2d pixel(const PlaceSighting& s) const {
    return features(s.view).undistorted[s.keypoint].cast<double>();
  }
  int octave(const PlaceSighting& s) const { return features(s.view).keypoints[s.keypoint].octave; }
};

struct PlacePair {
  PlaceNeighbourhood a, b;
  std::string doubt;  // empty, or why the two cannot be compared
};

// Collects up to `neighbours` views besides the keyframe itself and up to `witnesses` of either place. Two places of
// one submap share neither keyframes nor landmarks. Landmarks that are not finite are left out.
PlacePair gather_places(const Submap& a, int keyframe_a, const Submap& b, int keyframe_b, int neighbours,
                        int witnesses);

}  // namespace rumi::map_server
