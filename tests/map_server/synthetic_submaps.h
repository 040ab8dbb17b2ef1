// SPDX-License-Identifier: BSD-3-Clause
// Submaps of a known world: points with descriptors are filmed along a path, and submaps are made of parts of the film
// as a front or back process might make them, each in its own frame of reference and unit, with typical errors.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "map_server/model/map_model.h"
#include "slam/map/submap.h"
#include "tests/slam/synthetic_scene.h"

namespace rumi::testing {
using namespace rumi::map_server;

struct World {
  std::vector<Eigen::Vector3d> points;
  std::vector<Descriptor> descriptors;
  std::vector<double> octave0_distances;  // distance at which each point would be a keypoint of octave 0
};

// Makes points on the walls, floor and ceiling of a room of 6 x 3 x 6 m, and on things in it.
World make_room(unsigned seed, int points = 3000);
// Makes a tile of points that is repeated along x, 2 to 3 m away in z. Corresponding points of the tiles have equal
// descriptors.
World make_tiles(unsigned seed, double period_m, int points_per_tile, int tiles);

// cam_from_world of each image.
using CameraPath = std::vector<SE3>;
CameraPath walk_round(int images, double turns = 1);  // about the middle of the room, looking ahead and outwards
CameraPath straight(int images, const Eigen::Vector3d& step,
                    double yaw_per_image_rad = 0);  // looking along z at first

struct Image {
  int64_t utime_us = 0;
  SE3 cam_from_world;
  Features features;
  std::vector<int> point_of;  // the world point of each keypoint
};

struct FilmOptions {
  Camera camera = rumi::test_camera();
  unsigned seed = 1;
  Pyramid pyramid{};      // pyramid in which the keypoints are detected
  double noise_px = 0.5;  // standard deviation of the noise, at octave 0
  int wrong_bits = 10;    // wrong bits of each descriptor, at most
  int most_keypoints = 300;
  int every = 1;  // every so many images one has features; the others are poses only, and no keyframes
  int64_t first_utime_us = 1'000'000, period_us = 100'000;
};
std::vector<Image> film(const World& world, const CameraPath& path, const FilmOptions& options);

// How a submap deviates from the truth, image by image: the similarity that moves the true world before it is put into
// the submap. Empty if there is no distortion.
using Distortion = std::map<int, Sim3>;  // by image index; each is valid until the next one
// From image `from` on, scales the world and turns it about the vertical more and more; continuous along the path.
Distortion drift(const std::vector<Image>& images, int from, double log_scale_per_image, double yaw_per_image_rad = 0);
// From image `from` on, moves everything by this similarity.
Distortion jump(int from, const Sim3& moved_from_true);

struct SubmapRecipe {
  SubmapKey key{1, 1};
  SubmapKind kind = SubmapKind::kFront;
  int first = 0, last = 0;  // first and last image
  int keyframe_every = 3;   // images from one keyframe to the next; usually 1 in back submaps
  int keyframe_offset = 0;  // images from `first` to the first keyframe
  Sim3 submap_from_world{};
  Pyramid pyramid{};  // pyramid of the images
  unsigned seed = 1;
  double rotation_noise_deg = 0.05, center_noise_m = 0.003;
  double depth_noise = 0.01;      // standard deviation of a landmark's depth, as a share of it
  double point_share = 0.8;       // share of the world's points that the submap may have, if two keyframes see them
  double wrong_landmarks = 0;     // share of landmarks at a wrong depth on their ray
  double wrong_observations = 0;  // share of observations at the keypoint of another point
  Distortion distortion{};
  bool frames_between = true;  // true: every image has a pose, not only keyframes
};

struct SyntheticSubmap {
  Submap submap;
  Sim3 submap_from_world;
  std::map<int, int> point_of;  // landmark -> world point
};
SyntheticSubmap make_submap(const World& world, const std::vector<Image>& images, const SubmapRecipe& recipe,
                            const Camera& camera = rumi::test_camera());

// Returns a random similarity: any rotation, up to 10 m away, scale between 0.2 and 5.
Sim3 random_gauge(unsigned seed);

// Returns the placement with the same similarity at every keyframe.
Placement rigid_placement(const Submap& submap, const Sim3& map_from_submap);
// Places the submap in a map whose frame of reference is the world's.
PlacedSubmap truly_placed(const SyntheticSubmap& made);

// Returns the first inconsistency of the model, or an empty string. Every observation must be known to view and point,
// with at most one per view; numbers must be finite; every landmark may belong to at most one point.
std::string inconsistency(const MapModel& model);

// RMSE and maximum of the position errors after the best alignment, in the unit of the truth.
struct PathError {
  double rmse = 0, worst = 0;
};
PathError path_error(const std::vector<Eigen::Vector3d>& estimate, const std::vector<Eigen::Vector3d>& truth);

struct Sim3Error {
  double rotation_deg = 0, log_scale = 0;
  double translation = 0;  // error of the position of `at`, over `unit`
};
Sim3Error error_of(const Sim3& estimate, const Sim3& truth, const Eigen::Vector3d& at, double unit);

}  // namespace rumi::testing
