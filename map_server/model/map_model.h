// SPDX-License-Identifier: BSD-3-Clause
// The map while it is built: one view per image and one point per thing in the world, whichever submaps they came from.
// Joining needs no search: submaps made of the same image have its keypoints in common, and two landmarks that the same
// keypoint of the same image observes are one point (the paper's M_com, section IV.C).
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
    Pyramid pyramid;  // of the features
    std::shared_ptr<const Features> features;
    std::vector<int> points;             // per keypoint, kNone where it observes nothing
    std::vector<KeyframeRef> keyframes;  // of this image, back submaps first
  };
  struct Observation {
    int view = 0;
    int keypoint = 0;
  };
  struct Point {
    Eigen::Vector3d position;
    Descriptor descriptor{};
    std::vector<Observation> observations;  // at most one per view
    std::vector<LandmarkRef> landmarks;  // the landmarks that are this point; empty if it was fused into another point
  };
  std::vector<View> views;  // by image
  std::vector<Point> points;

  // Returns false, and changes nothing, if the view observes the point already or the keypoint observes another one.
  bool observe(int point, int view, int keypoint);
  void forget(int point, int view);
  // Makes `from` a part of `into`. An observation of `from` in a view that observes `into` elsewhere is dropped.
  void fuse(int into, int from);
};

struct PlacedSubmap {
  const Submap* submap = nullptr;
  Placement placement;
  bool fixed = false;  // no build may move it
};

// `same_px`: keypoints of the same image within this distance are taken for one. If submaps place the same image or
// point differently, a fixed submap is believed first, and its images become fixed views; then a back submap, because
// it was made with more time and of all frames.
MapModel join(const std::map<SubmapKey, PlacedSubmap>& submaps, double same_px);

// Drops from views and points the keyframes and landmarks that the submaps no longer have.
void forget_removed(const std::map<SubmapKey, PlacedSubmap>& submaps, MapModel* model);

// Returns the placements of the submaps that the model was joined from. The scale at a keyframe is the median over its
// landmarks; if there are too few, it is the scale of before. Fixed submaps keep their placement to the bit.
std::map<SubmapKey, Placement> split(const MapModel& model, const std::map<SubmapKey, PlacedSubmap>& submaps);

}  // namespace rumi::map_server
