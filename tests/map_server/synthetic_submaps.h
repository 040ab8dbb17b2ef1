// SPDX-License-Identifier: BSD-3-Clause
// Submaps of a world that is known: points with descriptors, filmed along a path, and what a front or back process
// might have made of stretches of that film, each in a frame of reference and unit of its own, with the errors that
// such submaps have.
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
  std::vector<double> octave0_distances;  // from where each would be a keypoint of octave 0
};

// Points on the walls, floor and ceiling of a room of 6 x 3 x 6 m, and of things that stand about in it.
World make_room(unsigned seed, int points = 3000);
// The same tile of points over and over along x, at a distance of 2 to 3 m in z; equal points have equal descriptors.
World make_tiles(unsigned seed, double period_m, int points_per_tile, int tiles);

// One pose cam_from_world per image.
using CameraPath = std::vector<SE3>;
CameraPath walk_round(int images, double turns = 1);  // about the middle of the room, looking ahead and outwards
CameraPath straight(int images, const Eigen::Vector3d& step,
                    double yaw_per_image_rad = 0);  // looking along z at first

struct Image {
  int64_t utime_us = 0;
  SE3 cam_from_world;
  Features features;
  std::vector<int> point_of;  // per keypoint: of the world
};

struct FilmOptions {
  Camera camera = rumi::test_camera();
  unsigned seed = 1;
  Pyramid pyramid{};      // of whoever looks at the images
  double noise_px = 0.5;  // at octave 0
  int wrong_bits = 10;    // of a descriptor, at most
  int most_keypoints = 300;
  int every = 1;  // image that has features; the others are poses only, and no keyframes
  int64_t first_utime_us = 1'000'000, period_us = 100'000;
};
std::vector<Image> film(const World& world, const CameraPath& path, const FilmOptions& options);

// How a submap differs from the truth, from image to image: the similarity by which the true world is moved before it
// is put into the submap. Identity everywhere: no distortion.
using Distortion = std::map<int, Sim3>;  // by index of the image; the last one at or before an image holds
// The world goes on growing, and turning about the vertical, from image `from` on; continuous along the path.
Distortion drift(const std::vector<Image>& images, int from, double log_scale_per_image, double yaw_per_image_rad = 0);
// From image `from` on all is moved by this.
Distortion jump(int from, const Sim3& moved_from_true);

struct SubmapRecipe {
  SubmapKey key{1, 1};
  SubmapKind kind = SubmapKind::kFront;
  int first = 0, last = 0;  // images, inclusive
  int keyframe_every = 3;   // image `first` is one; back submaps: usually 1
  int keyframe_offset = 0;  // the first keyframe
  Sim3 submap_from_world{};
  Pyramid pyramid{};  // as that of the images
  unsigned seed = 1;
  double rotation_noise_deg = 0.05, center_noise_m = 0.003;
  double depth_noise = 0.01;      // of a landmark, of its depth
  double point_share = 0.8;       // of the world's points that it knows, if two keyframes see them
  double wrong_landmarks = 0;     // share of landmarks that lie anywhere on their ray
  double wrong_observations = 0;  // share of observations of another point's keypoint
  Distortion distortion{};
  bool frames_between = true;  // a pose for every image, not only for keyframes
};

struct SyntheticSubmap {
  Submap submap;
  Sim3 submap_from_world;
  std::map<int, int> point_of;  // landmark -> world point
};
SyntheticSubmap make_submap(const World& world, const std::vector<Image>& images, const SubmapRecipe& recipe,
                            const Camera& camera = rumi::test_camera());

// A random frame of reference: any rotation, within 10 m, scale between 0.2 and 5.
Sim3 random_gauge(unsigned seed);

// The same similarity at every keyframe.
Placement rigid_placement(const Submap& submap, const Sim3& map_from_submap);
// In a map that is the world.
PlacedSubmap truly_placed(const SyntheticSubmap& made);

// What does not hold of the model that must: empty if all is well. Both directions of every observation, at most one
// per view, finite numbers, every landmark of the submaps in one point at most.
std::string inconsistency(const MapModel& model);

// RMSE of positions after the best alignment, and the worst of them, in the unit of the truth.
struct PathError {
  double rmse = 0, worst = 0;
};
PathError path_error(const std::vector<Eigen::Vector3d>& estimate, const std::vector<Eigen::Vector3d>& truth);

struct Sim3Error {
  double rotation_deg = 0, log_scale = 0;
  double translation = 0;  // of the place of `at`, over `unit`
};
Sim3Error error_of(const Sim3& estimate, const Sim3& truth, const Eigen::Vector3d& at, double unit);

}  // namespace rumi::testing
