// SPDX-License-Identifier: BSD-3-Clause
// The served map while it is worked on: one view per image and one point per thing in the world, whichever submaps they
// came from. Joining needs no search: submaps made of the same image have its keypoints in common, and two landmarks
// that the same keypoint of the same image observes are one (the paper's M_com, section IV.C).
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
    std::vector<LandmarkRef> landmarks;     // that it is; empty: fused into another point
  };
  std::vector<View> views;  // by image
  std::vector<Point> points;

  // False, and nothing changed, if the view observes the point already or the keypoint observes something.
  bool observe(int point, int view, int keypoint);
  void forget(int point, int view);
  // `from` becomes part of `into`; an observation of `from` in a view that observes `into` elsewhere is dropped.
  void fuse(int into, int from);
};

struct PlacedSubmap {
  const Submap* submap = nullptr;
  Placement placement;
  bool fixed = false;  // it stays where it is
};

// `same_px`: distance of keypoints that are taken for one where two submaps have the same image. Where submaps place
// the same image or point differently, the back submap is believed: it was made with more time, and of all frames;
// but before all others one that is fixed, whose images are fixed views.
MapModel join(const std::map<SubmapKey, PlacedSubmap>& submaps, double same_px);

// Forgets which keyframes and landmarks the views and points are where the submaps no longer have them.
void forget_removed(const std::map<SubmapKey, PlacedSubmap>& submaps, MapModel* model);

// Where the model puts the keyframes and landmarks of the submaps that it was joined from. The scale at a keyframe is
// the median over its landmarks, that before where there are too few. What is fixed stays to the bit.
std::map<SubmapKey, Placement> split(const MapModel& model, const std::map<SubmapKey, PlacedSubmap>& submaps);

}  // namespace rumi::map_server
