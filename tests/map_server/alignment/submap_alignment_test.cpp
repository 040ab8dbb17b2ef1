// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/alignment/submap_alignment.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <tuple>

#include "map_server/alignment/bent_end.h"
#include "tests/map_server/synthetic_submaps.h"

namespace rumi::testing {
using namespace rumi::map_server;
namespace {

struct Case {
  World world;
  CameraPath path;
  SubmapRecipe a, b;
  FilmOptions film;
};

struct Outcome {
  Alignment alignment;
  Correspondences common;
  Sim3Error error;  // translation: at the last shared camera, relative to 2.5 m
};

Outcome align(const SyntheticSubmap& a, const SyntheticSubmap& b, const AlignmentOptions& options = {}) {
  Outcome outcome;
  outcome.common = find_correspondences(a.submap, b.submap);
  outcome.alignment = align_submaps(a.submap, b.submap, outcome.common, options);
  if (outcome.common.keyframes.empty()) return outcome;
  const SE3& last = a.submap.keyframe(outcome.common.keyframes.back().a)->cam_from_submap;
  outcome.error = error_of(outcome.alignment.b_from_a, b.submap_from_world * a.submap_from_world.inverse(),
                           last.center(), 2.5 * b.submap_from_world.scale);
  return outcome;
}

std::pair<SyntheticSubmap, SyntheticSubmap> make(const Case& c) {
  const std::vector<Image> images = film(c.world, c.path, c.film);
  return {make_submap(c.world, images, c.a), make_submap(c.world, images, c.b)};
}

Outcome align(const Case& c, const AlignmentOptions& options = {}) {
  const auto [a, b] = make(c);
  return align(a, b, options);
}

// A front submap of the first 40 images of a path, and a back submap that begins before its end and goes on; they have
// `shared` keyframes in common.
Case typical(unsigned seed, int shared) {
  Case c{make_room(seed), walk_round(100), {}, {}, {}};
  c.film.seed = seed;
  constexpr int kLast = 39, kEvery = 3;
  const int first = kLast - kEvery * shared + 1;
  c.a = {.last = kLast, .keyframe_every = kEvery, .submap_from_world = random_gauge(2 * seed), .seed = seed};
  c.b = {.key = {1, -1},
         .kind = SubmapKind::kBack,
         .first = first,
         .last = kLast + 20,
         .keyframe_every = 1,
         .submap_from_world = random_gauge(2 * seed + 1),
         .seed = seed + 1};
  return c;
}

void print(const std::string& name, const Outcome& o) {
  std::printf(
      "%-20s %6.3f deg %7.3f %% scale %7.3f %% depth; sigma %.3f deg %.2f %%; landmarks %d of %d, keyframes %d of %d; "
      "%s\n",
      name.c_str(), o.error.rotation_deg, 100 * o.error.log_scale, 100 * o.error.translation,
      o.alignment.sigma_rotation_deg, 100 * o.alignment.sigma_log_scale, o.alignment.landmark_inliers,
      o.alignment.landmarks, o.alignment.keyframe_inliers, o.alignment.keyframes, o.alignment.doubt.c_str());
}

TEST(SubmapAlignment, FindsTheTruth) {
  for (int shared = 1; shared <= 10; ++shared) {
    const Outcome o = align(typical(shared, shared));
    print(std::to_string(shared) + " shared keyframes", o);
    EXPECT_EQ(o.alignment.keyframes, shared);
    EXPECT_EQ(o.alignment.doubt.empty(), shared >= kMinSharedKeyframes) << o.alignment.doubt;
    EXPECT_LT(o.error.rotation_deg, 0.2);
    EXPECT_LT(std::abs(o.error.log_scale), 0.02);
    EXPECT_LT(o.error.translation, 0.02);
  }
}

void expect_close(const Outcome& o, const std::string& name) {
  EXPECT_EQ(o.alignment.doubt, "") << name;
  EXPECT_LT(o.error.rotation_deg, 0.2) << name;
  EXPECT_LT(std::abs(o.error.log_scale), 0.02) << name;
  EXPECT_LT(o.error.translation, 0.01) << name;
}

TEST(SubmapAlignment, NeedsNoParticularMotion) {
  const std::pair<std::string, CameraPath> paths[] = {{"sideways", straight(40, {0.05, 0, 0})},
                                                      {"ahead", straight(40, {0, 0, 0.04})},
                                                      {"tiny steps", straight(40, {0.003, 0, 0})}};
  for (const auto& [name, path] : paths)
    for (unsigned seed = 21; seed <= 23; ++seed) {
      Case c = typical(seed, 4);
      c.path = path;
      c.a.last = 19;
      c.b.first = 8;
      c.b.last = 39;
      const Outcome o = align(c);
      if (seed == 21) print(name, o);
      expect_close(o, name);
    }
}

// Each submap knows the depths from where the camera walked before or after. In the shared images it turns on the spot
// or stands still, so that no reprojection error determines the scale.
TEST(SubmapAlignment, KnowsTheScaleWhereTheCameraDoesNotMove) {
  for (double yaw_rad : {0.0, 0.02, 0.05})
    for (unsigned seed = 31; seed <= 33; ++seed) {
      Case c = typical(seed, 4);
      c.path = straight(24, {0.05, 0, 0});
      const SE3 turn(so3_exp({0, -yaw_rad, 0}), Eigen::Vector3d::Zero()),
          step(Eigen::Quaterniond::Identity(), {-0.05, 0, 0});
      for (int i = 24; i < 48; ++i) c.path.push_back((i < 36 ? turn : step) * c.path.back());
      c.a.last = 35;
      c.b.first = 24;
      c.b.last = 47;
      const Outcome o = align(c);
      if (seed == 31) print(fmt::format("turns {:.0f} deg", 12 * yaw_rad * 180 / M_PI), o);
      expect_close(o, fmt::format("{} rad an image, seed {}", yaw_rad, seed));
    }
}

TEST(SubmapAlignment, BearsThirtyPercentOfWrongLandmarks) {
  for (unsigned seed = 41; seed <= 45; ++seed) {
    Case c = typical(seed, 5);
    c.a.wrong_landmarks = 0.3;
    c.b.wrong_observations = 0.05;
    const Outcome o = align(c);
    if (seed == 41) print("30 % wrong", o);
    expect_close(o, std::to_string(seed));
    EXPECT_LT(o.alignment.landmark_inliers, 0.9 * o.alignment.landmarks);
    EXPECT_EQ(std::count(o.alignment.inlier.begin(), o.alignment.inlier.end(), 1), o.alignment.landmark_inliers);
    EXPECT_EQ(o.alignment.inlier.size(), o.common.landmarks.size());
    EXPECT_EQ(o.alignment.keyframe_inlier.size(), o.common.keyframes.size());
  }
}

TEST(SubmapAlignment, IsTheSameBothWays) {
  const auto [a, b] = make(typical(51, 5));
  const Outcome forward = align(a, b), backward = align(b, a);
  const Sim3Error error = error_of(backward.alignment.b_from_a.inverse(), forward.alignment.b_from_a,
                                   a.submap.keyframe(forward.common.keyframes[0].a)->cam_from_submap.center(), 1);
  EXPECT_LT(error.rotation_deg, 0.01);
  EXPECT_LT(std::abs(error.log_scale), 1e-3);
  EXPECT_EQ(forward.alignment.landmark_inliers, backward.alignment.landmark_inliers);
}

// The alignment takes poses and landmarks as exact. Therefore the errors exceed its sigmas, but only by a small factor.
TEST(SubmapAlignment, SigmaIsNotFarFromTheError) {
  constexpr int kRuns = 40;
  double rotation = 0, scale = 0;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    const Outcome o = align(typical(seed, 4));
    rotation += std::pow(o.error.rotation_deg / o.alignment.sigma_rotation_deg, 2) / (3 * kRuns);
    scale += std::pow(o.error.log_scale / o.alignment.sigma_log_scale, 2) / kRuns;
  }
  std::printf("error over sigma: rotation %.2f (per axis), scale %.2f\n", std::sqrt(rotation), std::sqrt(scale));
  EXPECT_GT(std::sqrt(rotation), 0.2);
  EXPECT_LT(std::sqrt(rotation), 3);
  EXPECT_GT(std::sqrt(scale), 0.2);
  EXPECT_LT(std::sqrt(scale), 6);
}

// --- Doubts

TEST(SubmapAlignment, DoubtsWhatSharesOneKeyframe) {
  EXPECT_EQ(align(typical(61, 1)).alignment.doubt, "1 shared keyframes of 2 wanted");
  Correspondences nothing;
  EXPECT_EQ(align_submaps({}, {}, nothing, {}).doubt, "0 shared keyframes of 2 wanted");
}

TEST(SubmapAlignment, TwoKeyframesAreEnoughWhereOneHoldsInTheOther) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Outcome o = align(typical(seed, 2));
    EXPECT_EQ(o.alignment.doubt, "") << seed;
    EXPECT_LT(std::abs(o.error.log_scale), 0.05) << seed;
    auto [a, b] = make(typical(seed, 2));
    const int shared = find_correspondences(a.submap, b.submap).keyframes.front().b;
    b.submap.keyframe(shared)->cam_from_submap.translation.x() += 2;
    EXPECT_NE(align(a, b).alignment.doubt, "") << seed;
  }
}

TEST(SubmapAlignment, DoubtsWhatSharesTooFewLandmarks) {
  Case c = typical(62, 4);
  c.a.point_share = 0.05;
  const Alignment few = align(c).alignment;
  EXPECT_LT(few.landmarks, 40);
  EXPECT_EQ(few.doubt, fmt::format("{0} of {0} common landmarks agree, 40 wanted", few.landmarks));
  c.a.point_share = 0.02;  // no keyframe has enough landmarks for a proposal
  const Alignment fewer = align(c).alignment;
  EXPECT_EQ(fewer.doubt, fmt::format("0 of {} common landmarks agree, 40 wanted", fewer.landmarks));
}

void shift(Keyframe* keyframe, double distance) { keyframe->cam_from_submap.translation.x() += distance; }

TEST(SubmapAlignment, DoubtsWhereMostLandmarksDisagree) {
  auto [a, b] = make(typical(63, 6));
  for (int k = 0; k < 6; ++k)
    if (k % 3 != 0) shift(&b.submap.keyframes.at(k * 3 + 2), (0.3 + 0.1 * k) * b.submap_from_world.scale);
  const Outcome o = align(a, b);
  EXPECT_EQ(o.alignment.doubt, fmt::format("{} of {} common landmarks agree, {} wanted", o.alignment.landmark_inliers,
                                           o.alignment.landmarks, (o.alignment.landmarks + 1) / 2));
  EXPECT_LT(o.alignment.landmark_inliers, o.alignment.landmarks / 2);
}

TEST(SubmapAlignment, DoubtsWhereMostKeyframesDisagree) {
  auto [a, b] = make(typical(64, 4));
  // Two keyframes have next to nothing in common and are in a wrong place.
  for (int k : {0, 2}) {
    Keyframe& keyframe = b.submap.keyframes.at(k * 3 + 2);
    shift(&keyframe, 2 * b.submap_from_world.scale);
    for (size_t i = 10; i < keyframe.landmark_ids.size(); ++i)
      if (keyframe.landmark_ids[i] != kNone) b.submap.remove_observation(keyframe.landmark_ids[i], keyframe.id);
  }
  EXPECT_EQ(align(a, b).alignment.doubt, "2 of 4 shared keyframes agree");
}

// The front submap may be bent at its end, the back submap at its beginning or end if that lies within the front
// submap.
TEST(SubmapAlignment, WithoutEitherEndItIsTriedTheLongestFirst) {
  const auto [front, back] = make(typical(1, 6));
  const Correspondences common = find_correspondences(front.submap, back.submap, 1.0);
  ASSERT_EQ(common.keyframes.size(), 6u);
  std::vector<std::tuple<size_t, size_t, bool>> runs;
  for (const SharedRun& run : runs_beside_bent_end(front.submap, back.submap, common))
    runs.emplace_back(run.first, run.count, run.is_back_bent);
  EXPECT_EQ(runs, (decltype(runs){{0, 5, false}, {1, 5, true}, {0, 4, false}, {2, 4, true}, {1, 4, true}}))
      << "and last without both ends";
  EXPECT_TRUE(runs_beside_bent_end(front.submap, front.submap, common).empty()) << "two front submaps";
}

TEST(SubmapAlignment, DoubtsWhatIsNotKnownWellEnough) {
  Case c = typical(65, 4);
  const Outcome known = align(c);
  AlignmentOptions strict;
  strict.max_sigma_log_scale = 0.5 * known.alignment.sigma_log_scale;
  const std::string doubt = fmt::format("known to {:.2f} deg and {:.1f} % of the scale only",
                                        known.alignment.sigma_rotation_deg, 100 * known.alignment.sigma_log_scale);
  EXPECT_EQ(align(c, strict).alignment.doubt, doubt);
  strict = {};
  strict.max_sigma_rotation_deg = 0.5 * known.alignment.sigma_rotation_deg;
  EXPECT_EQ(align(c, strict).alignment.doubt, doubt);
}

// The camera stands still, and the depths in one of the submaps are wrong.
TEST(SubmapAlignment, DoubtsAScaleThatNothingTells) {
  Case c = typical(66, 4);
  c.path = straight(60, {0, 0, 0});
  c.a.wrong_landmarks = 1;
  const std::string doubt = align(c).alignment.doubt;
  EXPECT_THAT(doubt, ::testing::AnyOf(::testing::HasSubstr("scale"), ::testing::HasSubstr("not converged")));
}

TEST(SubmapAlignment, DoubtsWhereEvenAndOddKeyframesContradict) {
  auto [a, b] = make(typical(67, 10));
  for (int k : {1, 5, 9}) shift(&b.submap.keyframes.at(k * 3 + 2), 0.4 * b.submap_from_world.scale);
  const Outcome o = align(a, b);
  EXPECT_EQ(o.alignment.keyframe_inliers, 7);
  EXPECT_EQ(o.alignment.doubt, "what half of the shared keyframes tell does not hold in the other half");
}

TEST(SubmapAlignment, NumbersThatAreNoneAgreeWithNothing) {
  auto [a, b] = make(typical(68, 9));
  for (int id = 0; id < 20; ++id)
    if (Landmark* landmark = a.submap.landmark(id)) landmark->position.setConstant(id % 2 ? NAN : INFINITY);
  expect_close(align(a, b), "landmarks");
  b.submap.keyframes.at(5).cam_from_submap.translation.setConstant(NAN);
  const Outcome one = align(a, b);
  expect_close(one, "one pose");
  EXPECT_EQ(one.alignment.keyframe_inliers, 8);
  for (auto& [id, keyframe] : b.submap.keyframes) keyframe.cam_from_submap.translation.setConstant(NAN);
  const Outcome all = align(a, b);
  EXPECT_NE(all.alignment.doubt, "");
  EXPECT_TRUE(all.alignment.b_from_a.is_finite());
}

}  // namespace
}  // namespace rumi::testing
