// SPDX-License-Identifier: BSD-3-Clause
// The map during a build: one view per image and one point per thing in the world, from whichever submaps they came.
// Joining submaps needs no search: submaps made of the same image share its keypoints, and two landmarks that the same
// keypoint of an image observes are one point (the paper's M_com, section IV.C).
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "map_server/atlas/placement.h"
#include "map_server/links/joint.h"
#include "slam/map/submap.h"

namespace rumi::map_server {

struct MapModel {
  struct View {
    ImageId image;
    SE3 cam_from_map;
    bool fixed = false;
    Camera camera;
    Pyramid pyramid;  // pyramid in which the features were detected
    std::shared_ptr<const Features> features;
    std::vector<int> points;             // by keypoint: the point that it observes, or kNone
    std::vector<KeyframeRef> keyframes;  // keyframes of this image, those of back submaps first
  };
  struct Observation {
    int view = 0;
    int keypoint = 0;
  };
  struct Point {
    Eigen::Vector3d position;
    Descriptor descriptor{};
    std::vector<Observation> observations;  // at most one per view
    std::vector<LandmarkRef> landmarks;     // landmarks that are this point; empty if it was fused into another point
  };
  std::vector<View> views;  // sorted by image
  std::vector<Point> points;

  // Returns false, and changes nothing, if the view observes the point already or the keypoint observes another point.
  bool observe(int point, int view, int keypoint);
  void forget(int point, int view);
  // Fuses the point `from` into `into`. Its observations in views that already observe `into` are dropped.
  void fuse(int into, int from);
};

struct PlacedSubmap {
  const Submap* submap = nullptr;
  Placement placement;
  bool fixed = false;  // whether no build may move it
};

// Makes one model of the submaps. Keypoints of the same image within `same_px` count as one. If submaps place the same
// image or point differently, fixed submaps have priority, and their images become fixed views; then back submaps,
// because they were made with more time and from all frames.
MapModel join(const std::map<SubmapKey, PlacedSubmap>& submaps, double same_px);

// Removes from views and points the keyframes and landmarks that the submaps no longer have.
void forget_removed(const std::map<SubmapKey, PlacedSubmap>& submaps, MapModel* model);

// Returns new placements of the submaps that the model was joined from. The scale at a keyframe is the median over its
// landmarks; if they are too few, the scale stays unchanged. Fixed submaps keep their placement unchanged to the bit.
std::map<SubmapKey, Placement> split(const MapModel& model, const std::map<SubmapKey, PlacedSubmap>& submaps);

}  // namespace rumi::map_server
