// SPDX-License-Identifier: BSD-3-Clause
// A place in a submap: a keyframe, the keyframes that share most landmarks with it, and those landmarks.
#pragma once

#include <string>
#include <vector>

#include "slam/features/keypoint_grid.h"
#include "slam/map/submap.h"

namespace rumi::map_server {

// A keyframe, prepared for matching.
struct PlaceView {
  const Keyframe* keyframe = nullptr;
  std::vector<int> known;           // keypoints that observe a landmark of the neighbourhood, ascending
  std::vector<int> landmark_index;  // by keypoint: index into PlaceNeighbourhood::landmarks, or kNone
  KeypointGrid grid;                // all keypoints, by undistorted pixel
};

struct PlaceSighting {
  int view = kNone;  // index into PlaceNeighbourhood::views
  int keypoint = kNone;
};

struct PlaceLandmark {
  int id = kNone;
  Eigen::Vector3d position;              // position in the submap's frame of reference; finite
  std::vector<PlaceSighting> sightings;  // at least one sighting
};

struct PlaceNeighbourhood {
  const Submap* submap = nullptr;
  std::vector<PlaceView> views;      // views that an alignment uses, the keyframe itself first
  std::vector<PlaceView> witnesses;  // covisible keyframes that the alignment does not use, so that they can confirm it
  std::vector<PlaceLandmark> landmarks;  // landmarks that the views observe, by ascending id

  const Features& features(int view) const { return *views[view].keyframe->features; }
  Eigen::Vector2d pixel(const PlaceSighting& s) const {
    return features(s.view).undistorted[s.keypoint].cast<double>();
  }
  int octave(const PlaceSighting& s) const { return features(s.view).keypoints[s.keypoint].octave; }
};

struct PlacePair {
  PlaceNeighbourhood a, b;
  std::string doubt;  // why the two cannot be compared; empty if they can
};

// Collects up to `neighbours` views besides the keyframe itself, and up to `witnesses` witnesses, for each place. Two
// places of one submap share no keyframes and no landmarks. Landmarks that are not finite are left out.
PlacePair gather_places(const Submap& a, int keyframe_a, const Submap& b, int keyframe_b, int neighbours,
                        int witnesses);

}  // namespace rumi::map_server
