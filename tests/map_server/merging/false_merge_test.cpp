// SPDX-License-Identifier: BSD-3-Clause
// Pairs of submaps that must not be merged, and pairs that must: the purpose of the alignment.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "map_server/alignment/submap_alignment.h"
#include "tests/map_server/synthetic_submaps.h"

namespace rumi::testing {
using namespace rumi::map_server;
namespace {

constexpr int kEvery = 3;

// The camera and the pyramid with which b was made.
struct Maker {
  Camera camera = test_camera();
  Pyramid pyramid{};
};

struct Pair {
  SyntheticSubmap a, b;
  Sim3 a_moved{};  // distortion of a where the two submaps meet
};

// A front submap, and a back submap that begins before its end and goes on. They have `shared` keyframes in common,
// between 3 and 10.
struct Recipes {
  SubmapRecipe front, back;
  explicit Recipes(unsigned seed, int shared) {
    front = {.last = 39, .keyframe_every = kEvery, .submap_from_world = random_gauge(3 * seed), .seed = seed};
    back = {.key = {1, -1},
            .kind = SubmapKind::kBack,
            .first = front.last - kEvery * (shared - 1),
            .last = front.last + 16,
            .keyframe_every = kEvery,
            .submap_from_world = random_gauge(3 * seed + 1),
            .seed = seed + 1};
  }
};

Alignment align(const SyntheticSubmap& a, const SyntheticSubmap& b) {
  return align_submaps(a.submap, b.submap, find_correspondences(a.submap, b.submap), {});
}

int shared_keyframes(unsigned seed) { return 3 + static_cast<int>(seed % 8); }

// --- Pairs that must not merge. Each function makes a pair of submaps from a seed.

// Makes a submap of another place, with so many keypoints that many fall on the same pixels.
SyntheticSubmap make_there(const World& world, const CameraPath& path, unsigned seed, const Maker& maker,
                           SubmapRecipe recipe) {
  const auto images = film(world, path,
                           {.camera = maker.camera,
                            .seed = seed + 1,
                            .pyramid = maker.pyramid,
                            .wrong_bits = 0,
                            .most_keypoints = 1500,
                            .every = kEvery});
  recipe.pyramid = maker.pyramid;
  return make_submap(world, images, recipe, maker.camera);
}

// The second submap is of another room, filmed at the same times along another path, with so many keypoints that many
// fall on the same pixels.
Pair another_room(unsigned seed, const Maker& maker) {
  Recipes r(seed, shared_keyframes(seed));
  const World here = make_room(seed, 16000), there = make_room(seed + 5000, 16000);
  const auto images =
      film(here, walk_round(60, 0.6), {.seed = seed, .wrong_bits = 0, .most_keypoints = 1500, .every = kEvery});
  CameraPath other = walk_round(160, -1.6);
  other.erase(other.begin(), other.begin() + 100);
  return {make_submap(here, images, r.front), make_there(there, other, seed, maker, r.back)};
}

// The second submap has all its depths reversed: motion to the left by parallax is taken for motion to the right by
// rotation (the classical ambiguity of a narrow field of view).
Pair turned_over(unsigned seed, const Maker& maker) {
  Recipes r(seed, shared_keyframes(seed));
  const World world = make_room(seed);
  const auto images = film(world, walk_round(60, 0.6), {.seed = seed, .every = kEvery});
  const auto images_of_b = film(world, walk_round(60, 0.6), {.seed = seed, .pyramid = maker.pyramid, .every = kEvery});
  r.back.pyramid = maker.pyramid;
  Pair pair{make_submap(world, images, r.front), make_submap(world, images_of_b, r.back)};
  SyntheticSubmap& b = pair.b;
  const SE3 middle = b.submap.keyframes.at(static_cast<int>(b.submap.keyframes.size()) / 4).cam_from_submap;
  const double depth = 2.5 * b.submap_from_world.scale;
  const auto mirror = [&](const Eigen::Vector3d& p) {  // reflects about a plane 2.5 m ahead
    Eigen::Vector3d q = middle * p;
    q.z() = std::max(0.1 * depth, 2 * depth - q.z());
    return Eigen::Vector3d(middle.inverse() * q);
  };
  for (auto& [id, keyframe] : b.submap.keyframes) {
    SE3 step = keyframe.cam_from_submap * middle.inverse();
    step.translation = -step.translation;
    step.rotation = step.rotation.conjugate();
    keyframe.cam_from_submap = step * middle;
  }
  for (auto& [id, landmark] : b.submap.landmarks) landmark.position = mirror(landmark.position);
  return pair;
}

// The second submap is of the mirrored room: pixels agree only by chance.
Pair mirrored_room(unsigned seed, const Maker& maker) {
  Recipes r(seed, shared_keyframes(seed));
  const World world = make_room(seed, 16000);
  World mirrored = world;
  for (Eigen::Vector3d& p : mirrored.points) p.x() = -p.x();
  CameraPath path = walk_round(60, 0.6), other = path;
  for (SE3& pose : other) {  // mirrors the camera's path
    SE3 world_from_cam = pose.inverse();
    world_from_cam.translation.x() *= -1;
    const Eigen::Quaterniond q = world_from_cam.rotation;
    world_from_cam.rotation = Eigen::Quaterniond(q.w(), q.x(), -q.y(), -q.z());
    pose = world_from_cam.inverse();
  }
  const auto images = film(world, path, {.seed = seed, .wrong_bits = 0, .most_keypoints = 1500, .every = kEvery});
  return {make_submap(world, images, r.front), make_there(mirrored, other, seed, maker, r.back)};
}

// A wall of equal tiles: from one of the shared images on, the back submap has mistaken one tile for the next.
Pair repeated_texture(unsigned seed, const Maker& maker) {
  const int shared = shared_keyframes(seed);
  Recipes r(seed, shared);
  const World world = make_tiles(seed, 0.5, 12, 24);
  const auto images = film(world, straight(60, {0.03, 0, 0}), {.seed = seed, .most_keypoints = 400, .every = kEvery});
  const auto images_of_b = film(world, straight(60, {0.03, 0, 0}),
                                {.seed = seed, .pyramid = maker.pyramid, .most_keypoints = 400, .every = kEvery});
  r.back.pyramid = maker.pyramid;
  const int middle = r.back.first + kEvery * shared / 2;
  r.back.distortion = jump(middle, Sim3(1, Eigen::Quaterniond::Identity(), {seed % 2 ? 0.5 : -0.5, 0, 0}));
  return {make_submap(world, images, r.front), make_submap(world, images_of_b, r.back)};
}

// The back submap consists of two groups of images that nothing connects, with a jump in the middle of the shared
// images.
Pair two_groups(unsigned seed, const Maker& maker) {
  const int shared = shared_keyframes(seed);
  Recipes r(seed, shared);
  const World world = make_room(seed);
  const auto images = film(world, walk_round(60, 0.6), {.seed = seed, .every = kEvery});
  const auto images_of_b = film(world, walk_round(60, 0.6), {.seed = seed, .pyramid = maker.pyramid, .every = kEvery});
  r.back.pyramid = maker.pyramid;
  const Sim3 gauge = random_gauge(seed + 777);
  const Sim3 moved(std::exp(seed % 2 ? 0.3 : -0.3), so3_exp(0.1 * gauge.translation.normalized()),
                   0.05 * gauge.translation);
  r.back.distortion = jump(r.back.first + kEvery * shared / 2, moved);
  return {make_submap(world, images, r.front), make_submap(world, images_of_b, r.back)};
}

// The back submap is from a window with almost no parallax: each depth is a guess, and the camera hardly moves.
Pair no_parallax(unsigned seed, const Maker& maker) {
  Recipes r(seed, shared_keyframes(seed));
  const World world = make_room(seed);
  const auto images = film(world, walk_round(60, 0.6), {.seed = seed, .every = kEvery});
  const auto images_of_b = film(world, walk_round(60, 0.6), {.seed = seed, .pyramid = maker.pyramid, .every = kEvery});
  r.back.pyramid = maker.pyramid;
  r.back.wrong_landmarks = 1;
  Pair pair{make_submap(world, images, r.front), make_submap(world, images_of_b, r.back)};
  for (auto& [id, keyframe] : pair.b.submap.keyframes) {
    const Eigen::Vector3d first = pair.b.submap.keyframes.at(0).cam_from_submap.center();
    const Eigen::Vector3d center = first + 0.05 * (keyframe.cam_from_submap.center() - first);
    keyframe.cam_from_submap.translation = -(keyframe.cam_from_submap.rotation * center);
  }
  return pair;
}

// As no_parallax(), but the camera did stand still: nothing contradicts the back submap, and nothing confirms it.
Pair standing_still(unsigned seed, const Maker& maker) {
  Recipes r(seed, shared_keyframes(seed));
  const World world = make_room(seed);
  CameraPath path = straight(r.back.first - 3, {0.04, 0, 0});
  while (path.size() < 60) path.push_back(path.back());
  const auto images = film(world, path, {.seed = seed, .every = kEvery});
  const auto images_of_b = film(world, path, {.seed = seed, .pyramid = maker.pyramid, .every = kEvery});
  r.back.pyramid = maker.pyramid;
  r.back.wrong_landmarks = 1;
  r.front.center_noise_m = r.back.center_noise_m = 0.0005;
  return {make_submap(world, images, r.front), make_submap(world, images_of_b, r.back)};
}

// The last keyframes of the front submap, which are the shared ones, drifted before tracking was lost, in scale too.
Pair garbage_tail(unsigned seed, const Maker& maker) {
  Recipes r(seed, shared_keyframes(seed));
  const World world = make_room(seed);
  const auto images = film(world, walk_round(60, 0.6), {.seed = seed, .every = kEvery});
  const auto images_of_b = film(world, walk_round(60, 0.6), {.seed = seed, .pyramid = maker.pyramid, .every = kEvery});
  r.back.pyramid = maker.pyramid;
  const double sign = seed % 2 ? 1 : -1;
  r.front.distortion = drift(images, r.back.first, sign * 0.04, 0.03);
  r.front.wrong_landmarks = 0.3;
  return {make_submap(world, images, r.front), make_submap(world, images_of_b, r.back)};
}

struct WrongKind {
  const char* name;
  Pair (*make)(unsigned seed, const Maker& maker);
};
constexpr WrongKind kWrong[] = {{"another room", another_room},     {"mirrored room", mirrored_room},
                                {"turned over", turned_over},       {"repeated texture", repeated_texture},
                                {"two groups", two_groups},         {"no parallax", no_parallax},
                                {"standing still", standing_still}, {"garbage tail", garbage_tail}};

void expect_all_refused(const WrongKind& kind, const char* how, const Maker& maker) {
  int accepted = 0, most_landmarks = 0;
  for (unsigned seed = 1; seed <= 25; ++seed) {
    const Pair pair = kind.make(seed, maker);
    const Alignment alignment = align(pair.a, pair.b);
    accepted += alignment.doubt.empty();
    most_landmarks = std::max(most_landmarks, alignment.landmark_inliers);
    EXPECT_FALSE(alignment.doubt.empty()) << kind.name << how << ", seed " << seed;
  }
  std::printf("%s%s: %d of 25 accepted, at most %d landmarks agree\n", kind.name, how, accepted, most_landmarks);
}

TEST(FalseMerge, None) {
  for (const WrongKind& kind : kWrong) expect_all_refused(kind, "", {});
}

// Submaps of the same image have the same lens, so other lenses are tested with other rooms only.
TEST(FalseMerge, NoneOfAnotherCamera) {
  for (const WrongKind& kind : {kWrong[0], kWrong[1]})
    expect_all_refused(kind, ", of another camera", {.camera = test_fisheye()});
}

TEST(FalseMerge, NoneOfAnotherPyramid) {
  for (const WrongKind& kind : {kWrong[0], kWrong[2], kWrong[3], kWrong[4], kWrong[5], kWrong[7]})
    expect_all_refused(kind, ", of another pyramid", {.pyramid = {4, 1.5}});
}

// --- Pairs that must merge

Pair typical(unsigned seed) {
  const Recipes r(seed, shared_keyframes(seed));
  const World world = make_room(seed);
  const auto images = film(world, walk_round(60, 0.6), {.seed = seed, .every = kEvery});
  return {make_submap(world, images, r.front), make_submap(world, images, r.back)};
}

Pair fisheye(unsigned seed) {
  const Recipes r(seed, shared_keyframes(seed));
  const World world = make_room(seed);
  const auto images = film(world, walk_round(60, 0.6), {.camera = test_fisheye(), .seed = seed, .every = kEvery});
  return {make_submap(world, images, r.front, test_fisheye()), make_submap(world, images, r.back, test_fisheye())};
}

Pair wrong_landmarks(unsigned seed) {
  Recipes r(seed, shared_keyframes(seed));
  const World world = make_room(seed);
  const auto images = film(world, walk_round(60, 0.6), {.seed = seed, .every = kEvery});
  r.front.wrong_landmarks = 0.2;
  r.back.wrong_landmarks = 0.1;
  r.back.wrong_observations = 0.05;
  return {make_submap(world, images, r.front), make_submap(world, images, r.back)};
}

Pair sideways(unsigned seed) {
  const Recipes r(seed, shared_keyframes(seed));
  const World world = make_room(seed);
  const auto images = film(world, straight(60, {0.03, 0, 0}), {.seed = seed, .every = kEvery});
  return {make_submap(world, images, r.front), make_submap(world, images, r.back)};
}

Pair ahead(unsigned seed) {
  const Recipes r(seed, shared_keyframes(seed));
  const World world = make_room(seed);
  const auto images = film(world, straight(60, {0, 0, 0.03}), {.seed = seed, .every = kEvery});
  return {make_submap(world, images, r.front), make_submap(world, images, r.back)};
}

// The camera turns on the spot in the images that both have; each knows the depths from where it walked before or
// after.
Pair turning(unsigned seed) {
  Recipes r(seed, shared_keyframes(seed));
  const World world = make_room(seed);
  r.front.center_noise_m = r.back.center_noise_m = 0.0005;  // poses as accurate as after bundle adjustment
  CameraPath path = straight(r.back.first, {0.04, 0, 0});
  for (int i = r.back.first; i < 60; ++i) {
    const SE3 turn(so3_exp({0, -0.01, 0}), Eigen::Vector3d(i > r.front.last ? -0.04 : 0, 0, 0));
    path.push_back(turn * path.back());
  }
  const auto images = film(world, path, {.seed = seed, .every = kEvery});
  return {make_submap(world, images, r.front), make_submap(world, images, r.back)};
}

// The last fifth of the front submap's shared keyframes went wrong before it was lost.
Pair bad_end(unsigned seed) {
  const int shared = 5 + static_cast<int>(seed % 6);
  Recipes r(seed, shared);
  const World world = make_room(seed);
  const auto images = film(world, walk_round(60, 0.6), {.seed = seed, .every = kEvery});
  r.front.distortion = drift(images, r.front.last - kEvery * (shared / 5), 0.05, 0.05);
  return {make_submap(world, images, r.front), make_submap(world, images, r.back)};
}

// As bad_end(), but half of the shared keyframes are wrong. The other half is enough to merge the two.
Pair bent_end(unsigned seed) {
  Recipes r(seed, 8 + static_cast<int>(seed % 3));
  const World world = make_room(seed);
  const auto images = film(world, walk_round(60, 0.6), {.seed = seed, .every = kEvery});
  r.front.distortion = drift(images, r.front.last - kEvery * 4, 0.05, 0.05);
  return {make_submap(world, images, r.front), make_submap(world, images, r.back)};
}

// The scale of the front submap drifts slightly, as in every monocular map.
Pair drifting(unsigned seed) {
  Recipes r(seed, shared_keyframes(seed));
  const World world = make_room(seed);
  const auto images = film(world, walk_round(60, 0.6), {.seed = seed, .every = kEvery});
  r.front.distortion = drift(images, 0, seed % 2 ? 0.002 : -0.002);
  return {make_submap(world, images, r.front), make_submap(world, images, r.back),
          r.front.distortion.at((r.back.first + r.front.last) / 2)};
}

// Both see the same images, but the back submap has another pyramid, and therefore corners of other octaves.
Pair another_pyramid(unsigned seed) {
  Recipes r(seed, shared_keyframes(seed));
  const World world = make_room(seed);
  const auto images = film(world, walk_round(60, 0.6), {.seed = seed, .every = kEvery});
  const auto images_of_b = film(world, walk_round(60, 0.6), {.seed = seed, .pyramid = {4, 1.5}, .every = kEvery});
  r.back.pyramid = {4, 1.5};
  return {make_submap(world, images, r.front), make_submap(world, images_of_b, r.back)};
}

struct Kind {
  const char* name;
  Pair (*make)(unsigned seed);
};
constexpr Kind kRight[] = {{"typical", typical},
                           {"fisheye", fisheye},
                           {"wrong landmarks", wrong_landmarks},
                           {"sideways", sideways},
                           {"ahead", ahead},
                           {"turning on the spot", turning},
                           {"bad end", bad_end},
                           {"bent end", bent_end},
                           {"drifting", drifting},
                           {"another pyramid", another_pyramid}};

struct Errors {
  std::vector<double> rotation_deg, log_scale, translation;
  void add(const Sim3Error& error) {
    rotation_deg.push_back(error.rotation_deg);
    log_scale.push_back(std::abs(error.log_scale));
    translation.push_back(error.translation);
  }
  static std::string median_and_worst(std::vector<double> values, double unit) {
    if (values.empty()) return "-";
    std::sort(values.begin(), values.end());
    return std::to_string(unit * values[values.size() / 2]) + " / " + std::to_string(unit * values.back());
  }
};

TEST(TrueMerge, AlmostAll) {
  int accepted_of_all = 0;
  for (const Kind& kind : kRight) {
    int accepted = 0;
    Errors errors;
    std::string doubt = "no doubts";
    for (unsigned seed = 1; seed <= 25; ++seed) {
      const Pair pair = kind.make(seed);
      const Alignment alignment = align(pair.a, pair.b);
      if (!alignment.doubt.empty()) {
        doubt = alignment.doubt;
        continue;
      }
      ++accepted;
      const Sim3 truth = pair.b.submap_from_world * (pair.a.submap_from_world * pair.a_moved).inverse();
      const Eigen::Vector3d there = pair.b.submap.keyframes.at(0).cam_from_submap.center();
      errors.add(error_of(alignment.b_from_a, truth, truth.inverse() * there, 2.5 * pair.b.submap_from_world.scale));
    }
    accepted_of_all += accepted;
    ASSERT_GT(accepted, 0) << kind.name << ": " << doubt;
    EXPECT_LT(*std::max_element(errors.rotation_deg.begin(), errors.rotation_deg.end()), 0.3) << kind.name;
    EXPECT_LT(*std::max_element(errors.log_scale.begin(), errors.log_scale.end()), 0.03) << kind.name;
    EXPECT_LT(*std::max_element(errors.translation.begin(), errors.translation.end()), 0.02) << kind.name;
    std::printf("%-20s %d of 25; median / worst: %s deg, %s %% scale, %s %% of the depth; %s\n", kind.name, accepted,
                Errors::median_and_worst(errors.rotation_deg, 1).c_str(),
                Errors::median_and_worst(errors.log_scale, 100).c_str(),
                Errors::median_and_worst(errors.translation, 100).c_str(), doubt.c_str());
  }
  EXPECT_GE(accepted_of_all, 210);
}

}  // namespace
}  // namespace rumi::testing
