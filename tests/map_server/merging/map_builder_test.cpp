// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/merging/map_builder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <functional>

#include "tests/map_server/synthetic_submaps.h"

namespace rumi::testing {
using namespace rumi::map_server;
namespace {

using Placements = std::map<SubmapKey, Placement>;

// Front, back, front, back, front: three quarters of a round of the room, so that nothing is seen again at the end. The
// back submaps cover what the front lost.
class MapBuilderTest : public ::testing::Test {
 protected:
  static constexpr int64_t kSession = 7;
  const SubmapKey front1_{kSession, 1}, front2_{kSession, 2}, front3_{kSession, 3}, back1_{kSession, -1},
      back2_{kSession, -2};

  explicit MapBuilderTest(double drift_per_image = 0.001, const Pyramid& pyramid = {})
      : world_(make_room(1)), pyramid_(pyramid) {
    images_ = film(world_, walk_round(150, 0.75), {.pyramid = pyramid, .most_keypoints = 150, .every = 3});
    add(front1_, 0, 39, drift_per_image);
    add(back1_, 24, 69, 0);
    add(front2_, 54, 99, -drift_per_image);
    add(back2_, 84, 126, 0);
    add(front3_, 111, 149, drift_per_image);
  }

  void add(SubmapKey key, int first, int last, double drift_per_image) {
    SubmapRecipe recipe{.key = key, .first = first, .last = last};
    recipe.kind = key.id < 0 ? SubmapKind::kBack : SubmapKind::kFront;
    recipe.keyframe_every = 3;
    recipe.submap_from_world = random_gauge(static_cast<unsigned>(key.id + 10));
    recipe.pyramid = pyramid_;
    recipe.seed = static_cast<unsigned>(key.id + 20);
    recipe.wrong_observations = 0.02;
    recipe.wrong_landmarks = 0.03;
    if (drift_per_image != 0) recipe.distortion = drift(images_, first, drift_per_image);
    recipes_[key] = recipe;
    made_[key] = make_submap(world_, images_, recipe);
  }

  MapBuilder::Submaps submaps(const std::vector<SubmapKey>& keys = {}) const {
    MapBuilder::Submaps submaps;
    for (const auto& [key, made] : made_)
      if (keys.empty() || std::count(keys.begin(), keys.end(), key)) submaps[key] = &made.submap;
    return submaps;
  }

  static int image_of(int64_t utime_us) { return static_cast<int>((utime_us - 1'000'000) / 100'000); }

  // Of all frames of the placed submaps.
  PathError error(const Placements& placements) const {
    std::vector<Eigen::Vector3d> estimate, truth;
    for (const auto& [key, placement] : placements)
      for (const auto& [utime_us, frame] : made_.at(key).submap.frames) {
        estimate.push_back(placement.cam_from_map(made_.at(key).submap, frame).center());
        truth.push_back(images_[image_of(utime_us)].cam_from_world.center());
      }
    return path_error(estimate, truth);
  }

  static void print(const char* name, const BuiltMap& map, const PathError& error) {
    std::printf(
        "%-28s %zu submaps, ATE %.1f mm, worst %.1f mm; %d views, %d points, %d observations, rmse %.2f, %d outliers, "
        "%d fused\n",
        name, map.placements.size(), 1000 * error.rmse, 1000 * error.worst, map.report.views, map.report.points,
        map.report.observations, map.report.rmse, map.report.outliers, map.report.fused);
  }

  static bool finite(const Placements& placements) {
    for (const auto& [key, placement] : placements) {
      for (const auto& [utime_us, similarity] : placement.map_from_submap)
        if (!similarity.is_finite() || !(similarity.scale > 0)) return false;
      for (const auto& [id, position] : placement.landmarks)
        if (!position.allFinite()) return false;
    }
    return true;
  }

  World world_;
  Pyramid pyramid_;
  std::vector<Image> images_;
  std::map<SubmapKey, SubmapRecipe> recipes_;
  std::map<SubmapKey, SyntheticSubmap> made_;
};

// Octaves mean other sizes there: taken for the usual ones, observations would weigh wrongly.
class OfAnotherPyramid : public MapBuilderTest {
 protected:
  OfAnotherPyramid() : MapBuilderTest(0.001, {4, 1.5}) {}
};

TEST_F(OfAnotherPyramid, JoinsAChainAndWeighsObservationsAsTheyWereMade) {
  const auto rmse_of = [this](const Pyramid& pyramid) {
    for (auto& [key, made] : made_) made.submap.pyramid = pyramid;
    MapBuilder builder({});
    builder.find_links(submaps());
    const BuiltMap map = builder.build(submaps(), {});
    const PathError e = error(map.placements);
    print("another pyramid", map, e);
    EXPECT_EQ(map.placements.size(), 5u);
    EXPECT_LT(e.rmse, 0.04);
    return map.report.rmse;
  };
  const double right = rmse_of(pyramid_), wrong = rmse_of({8, 1.2});
  EXPECT_NEAR(right, 0.5 * std::sqrt(2), 0.1) << "the noise of the keypoints in x and y";
  EXPECT_GT(wrong, right + 0.1);
}

TEST_F(MapBuilderTest, JoinsAChain) {
  MapBuilder builder({});
  builder.find_links(submaps());
  int same_images = 0;
  for (const Link& link : builder.links()) {
    if (link.kind != Link::Kind::kSameImages) continue;
    EXPECT_EQ(link.doubt, "");
    ++same_images;
  }
  EXPECT_EQ(same_images, 4);
  const BuiltMap map = builder.build(submaps(), {});
  const PathError e = error(map.placements);
  print("chain", map, e);
  EXPECT_EQ(map.placements.size(), 5u);
  EXPECT_LT(e.rmse, 0.04);
  EXPECT_LT(e.worst, 0.1);
  EXPECT_TRUE(finite(map.placements));
}

TEST_F(MapBuilderTest, ABackSubmapAloneIsTheMapAndStaysWhereItIsWhenAFrontOneJoinsIt) {
  MapBuilder builder({});
  const auto alone = submaps({back1_}), both = submaps({front1_, back1_});
  builder.find_links(alone);
  const BuiltMap first = builder.build(alone, {});
  ASSERT_EQ(first.placements.size(), 1u);
  EXPECT_LT(error(first.placements).rmse, 0.02);
  const Sim3 before = first.placements.at(back1_).map_from_submap.begin()->second;

  builder.find_links(both);
  const BuiltMap second = builder.build(both, first.placements);
  ASSERT_EQ(second.placements.size(), 2u);
  EXPECT_LT(error(second.placements).rmse, 0.04);
  const Sim3 after = second.placements.at(back1_).map_from_submap.begin()->second;
  EXPECT_NEAR(after.scale, before.scale, 1e-9);
  EXPECT_LT((after.translation - before.translation).norm(), 1e-9);
}

TEST_F(MapBuilderTest, OfWhatDoesNotHangTogetherTheMostFramesAreTheMap) {
  MapBuilder builder({});
  add(front1_, 0, 20, 0);
  const auto apart = submaps({front1_, back2_});  // no image in common
  builder.find_links(apart);
  const BuiltMap map = builder.build(apart, {});
  EXPECT_EQ(map.placements.size(), 1u);
  EXPECT_TRUE(map.placements.contains(back2_));
}

TEST_F(MapBuilderTest, ACancelledSearchEndsSoon) {
  const std::atomic<bool> cancel = true;
  MapBuilder builder({}, &cancel);
  builder.find_links(submaps());
  EXPECT_TRUE(builder.links().empty());
}

TEST_F(MapBuilderTest, EqualInputGivesAnEqualMapToTheBit) {
  MapBuilder one({}), other({});
  one.find_links(submaps());
  other.find_links(submaps());
  const BuiltMap a = one.build(submaps(), {}), b = other.build(submaps(), {}), again = one.build(submaps(), {});
  ASSERT_EQ(a.placements.size(), 5u);
  for (const auto& [key, placement] : a.placements) {
    EXPECT_TRUE(same_place(placement, b.placements.at(key)));
    EXPECT_TRUE(same_place(placement, again.placements.at(key)));
  }
}

// What is placed already stays where it is until the adjustment; the anchor's first keyframe after it too.
TEST_F(MapBuilderTest, InAnyOrderOfArrival) {
  std::vector<SubmapKey> order = {front1_, back1_, front2_, back2_, front3_};
  std::sort(order.begin(), order.end());
  int number = 0;
  double worst_m = 0;
  do {
    if (number++ % 40 != 3) continue;  // 3 of 120
    MapBuilder builder({});
    std::vector<SubmapKey> here;
    Placements placed;
    for (const SubmapKey& key : order) {
      here.push_back(key);
      builder.find_links(submaps(here));
      const BuiltMap map = builder.build(submaps(here), placed);
      if (map.placements.empty()) continue;
      // A group that has more frames takes the place of the map, as a whole.
      const auto is_kept = [&map](const auto& p) { return map.placements.contains(p.first); };
      EXPECT_TRUE(std::all_of(placed.begin(), placed.end(), is_kept) ||
                  std::none_of(placed.begin(), placed.end(), is_kept));
      placed = map.placements;
    }
    EXPECT_EQ(placed.size(), 5u);
    const PathError e = error(placed);
    worst_m = std::max(worst_m, e.rmse);
    EXPECT_LT(e.rmse, 0.04) << number;
  } while (std::next_permutation(order.begin(), order.end()));
  std::printf("any order: ATE %.1f mm at most\n", 1000 * worst_m);
}

TEST_F(MapBuilderTest, RepeatedCallsKeepTheGaugeAndTheMap) {
  MapBuilder builder({});
  builder.find_links(submaps());
  Placements placed = builder.build(submaps(), {}).placements;
  const SubmapKey anchor = front1_;
  const Submap& submap = made_[anchor].submap;
  const SE3 at_first = placed[anchor].cam_from_map(submap.keyframes.at(0));
  const double scale_at_first = placed[anchor].at(submap.keyframes.at(0).utime_us).scale;
  Placements first = placed;
  double moved = 0;
  for (int round = 0; round < 4; ++round) {
    builder.find_links(submaps());
    const BuiltMap map = builder.build(submaps(), placed);
    moved = 0;
    for (const auto& [key, placement] : map.placements)
      for (const auto& [id, keyframe] : made_[key].submap.keyframes)
        moved = std::max(
            moved, (placement.cam_from_map(keyframe).center() - placed[key].cam_from_map(keyframe).center()).norm() /
                       scale_at_first / made_[anchor].submap_from_world.scale);
    print("again", map, error(map.placements));
    std::printf("   moved by %.2f mm at most\n", 1000 * moved);
    placed = map.placements;
    const SE3 now = placed[anchor].cam_from_map(submap.keyframes.at(0));
    EXPECT_LT((now.center() - at_first.center()).norm(), 1e-6 * made_[anchor].submap_from_world.scale);
    EXPECT_LT(rotation_error_deg(now, at_first), 1e-4);
  }
  EXPECT_LT(moved, 0.01);
  EXPECT_LT(error(placed).rmse, 0.04);
}

// Of a map that is large beside the limit.
TEST_F(MapBuilderTest, AWeldMovesWhatIsAroundWhatIsNewOnly) {
  MapBuilderOptions options;
  options.weld_keyframes = 20;
  MapBuilder builder(options);
  const auto some = submaps({front1_, back1_, front2_, back2_});
  builder.find_links(some);
  Placements placed = builder.build(some, {}, MapBuilder::Scope::kWeld).placements;
  ASSERT_EQ(placed.size(), 4u);
  builder.find_links(submaps());
  BuiltMap map = builder.build(submaps(), placed, MapBuilder::Scope::kWeld);
  ASSERT_TRUE(map.placements.contains(front3_));
  EXPECT_FALSE(map.placements.contains(front1_)) << "far away";
  EXPECT_EQ(map.placements.size() + map.unmoved.size(), 5u);
  EXPECT_EQ(map.report.members, 5);
  EXPECT_TRUE(same_place(map.placements.at(back2_), placed.at(back2_))) << "the rest hangs on it";
  for (const SubmapKey& key : map.unmoved) EXPECT_TRUE(map.placements.try_emplace(key, placed.at(key)).second);
  print("welded", map, error(map.placements));
  EXPECT_LT(error(map.placements).rmse, 0.08);
  // Nothing is known to be new: the whole map is looked at when it is due.
  const BuiltMap all = builder.build(submaps(), map.placements);
  print("adjusted", all, error(all.placements));
  EXPECT_EQ(all.placements.size(), 5u);
  EXPECT_LT(error(all.placements).rmse, 0.04);
}

TEST_F(MapBuilderTest, AnUnlinkedSubmapStaysOut) {
  MapBuilder builder({});
  const auto some = submaps({front1_, back1_, front2_, front3_});
  builder.find_links(some);
  const BuiltMap map = builder.build(some, {});
  EXPECT_EQ(map.placements.size(), 3u);
  EXPECT_FALSE(map.placements.contains(front3_));
  const auto alone = submaps({front1_, front3_});
  MapBuilder other({});
  other.find_links(alone);
  for (const Link& link : other.links()) EXPECT_FALSE(link.accepted());
  EXPECT_EQ(other.build(alone, {}).placements.size(), 1u);
  EXPECT_TRUE(MapBuilder({}).build({}, {}).placements.empty());
}

TEST_F(MapBuilderTest, ASubmapThatIsTheWholeMapIsAdjustedToo) {
  add(front1_, 0, 99, 0.003);
  const auto alone = submaps({front1_});
  MapBuilder builder({});
  builder.find_links(alone);
  EXPECT_TRUE(builder.build(alone, {}, MapBuilder::Scope::kWeld).placements.empty()) << "nothing was joined";
  const BuiltMap map = builder.build(alone, {});
  ASSERT_EQ(map.placements.size(), 1u);
  const PathError before = error({{front1_, Placement()}}), after = error(map.placements);
  print("alone, before", {}, before);
  print("alone, adjusted", map, after);
  EXPECT_LT(after.rmse, 0.5 * before.rmse);
}

TEST_F(MapBuilderTest, ARefusedLinkIsToldAndJoinsNothing) {
  recipes_[back1_].rotation_noise_deg = 10;
  recipes_[back1_].center_noise_m = 0.5;
  recipes_[back1_].wrong_landmarks = 1;
  made_[back1_] = make_submap(world_, images_, recipes_[back1_]);
  MapBuilder builder({});
  builder.find_links(submaps());
  int refused = 0;
  for (const Link& link : builder.links()) refused += link.kind == Link::Kind::kSameImages && !link.accepted();
  EXPECT_EQ(refused, 2);
  const BuiltMap map = builder.build(submaps(), {});
  print("without a back submap", map, error(map.placements));
  EXPECT_FALSE(map.placements.contains(back1_));
  EXPECT_TRUE(map.placements.contains(front3_));
  EXPECT_LT(error(map.placements).rmse, 0.04);
}

// Each part of it fits what it was made of; both together do not.
TEST_F(MapBuilderTest, ATornSubmapIsNotJoinedByLikenessEither) {
  recipes_[back1_].distortion = jump(33, Sim3(1.5, so3_exp({0, 0.3, 0}), {0.5, 0, 0}));
  made_[back1_] = make_submap(world_, images_, recipes_[back1_]);
  MapBuilder builder({});
  builder.find_links(submaps());
  for (const Link& link : builder.links())
    if (link.accepted()) {
      EXPECT_NE(std::minmax(link.a, link.b), std::minmax(front1_, back1_));
    }
  EXPECT_FALSE(builder.build(submaps(), {}).placements.contains(front1_));
}

// The front submap goes wrong half way, where nobody sees it: to the back submap of its end all seems to fit. Another
// back submap knows its beginning too.
TEST_F(MapBuilderTest, ALinkThatTheRestContradictsIsTakenOut) {
  recipes_[front1_].distortion = jump(18, Sim3(1.4, so3_exp({0, 0.2, 0}), {0.3, 0, 0}));
  made_[front1_] = make_submap(world_, images_, recipes_[front1_]);
  add({kSession, -3}, 0, 69, 0);
  const auto doubt = [](const MapBuilder& builder, SubmapKey a, SubmapKey b) {
    for (const Link& link : builder.links())
      if (link.kind == Link::Kind::kSameImages && std::minmax(link.a, link.b) == std::minmax(a, b)) return link.doubt;
    return std::string("no link");
  };
  MapBuilder builder({});
  builder.find_links(submaps());
  EXPECT_EQ(doubt(builder, front1_, back1_), "");
  EXPECT_EQ(doubt(builder, front1_, {kSession, -3}), "") << "its beginning is right";
  const BuiltMap map = builder.build(submaps(), {});
  print("one link wrong", map, error(map.placements));
  EXPECT_NE(doubt(builder, front1_, back1_).find("contradicts"), std::string::npos) << doubt(builder, front1_, back1_);
  EXPECT_EQ(map.placements.size(), 6u);
  EXPECT_LT(error(map.placements).rmse, 0.04);

  MapBuilderOptions trusting;
  trusting.graph.max_joint_chi2 = 1e9;
  MapBuilder other(trusting);
  other.find_links(submaps());
  const BuiltMap wrong = other.build(submaps(), {});
  print("the same, believed", wrong, error(wrong.placements));
  EXPECT_EQ(doubt(other, front1_, back1_), "");
}

// A wrong link was believed and served. More comes, and contradicts it: what it alone had joined leaves the map.
TEST_F(MapBuilderTest, AWrongMergeThatWasServedComesApart) {
  recipes_[front1_].distortion = jump(18, Sim3(1.4, so3_exp({0, 0.2, 0}), {0.3, 0, 0}));
  made_[front1_] = make_submap(world_, images_, recipes_[front1_]);
  MapBuilder builder({});
  builder.find_links(submaps());
  const Placements served = builder.build(submaps(), {}).placements;
  ASSERT_TRUE(served.contains(front1_)) << "to the back submap of its end all seems to fit";

  // What front1 is after its jump, it is for itself now.
  made_[front1_].submap.revision = 2;
  SubmapRecipe torn = recipes_[front1_];
  torn.distortion = jump(0, Sim3());
  torn.rotation_noise_deg = 10;
  torn.center_noise_m = 0.5;
  made_[front1_] = make_submap(world_, images_, torn);
  made_[front1_].submap.revision = 2;
  builder.find_links(submaps());
  const BuiltMap map = builder.build(submaps(), served);
  print("apart again", map, error(map.placements));
  EXPECT_EQ(map.placements.size(), 4u);
  EXPECT_FALSE(map.placements.contains(front1_) || map.unmoved.contains(front1_));
}

// The scale of one slips within the images that it shares with the only submap before it: the joints there contradict
// each other, however many of them are asked.
TEST_F(MapBuilderTest, AnOnlyTieHoldsWhereItAgreesBest) {
  recipes_[front2_].distortion = jump(58, Sim3(1.06, so3_exp({0, 0.06, 0}), {0.06, 0, 0}));
  made_[front2_] = make_submap(world_, images_, recipes_[front2_]);
  MapBuilderOptions strict;
  strict.graph.max_joint_chi2 = 0.01;
  MapBuilder builder(strict);
  builder.find_links(submaps());
  const BuiltMap map = builder.build(submaps(), {});
  print("only ties", map, error(map.placements));
  EXPECT_EQ(map.placements.size(), 5u);
  EXPECT_LT(error(map.placements).rmse, 0.04);
  for (const Link& link : builder.links()) EXPECT_EQ(link.doubt, "") << link.a.id << " and " << link.b.id;
}

TEST_F(MapBuilderTest, ASubmapThatGrows) {
  const SyntheticSubmap whole = made_[front3_];
  SubmapRecipe half = recipes_[front3_];
  half.last = 130;
  made_[front3_] = make_submap(world_, images_, half);
  MapBuilder builder({});
  builder.find_links(submaps());
  Placements placed = builder.build(submaps(), {}).placements;
  ASSERT_EQ(placed.size(), 5u);
  made_[front3_] = whole;
  made_[front3_].submap.revision = 2;
  EXPECT_LT(error(placed).rmse, 0.06);  // what is new follows the last keyframe that is placed
  builder.find_links(submaps());
  const BuiltMap map = builder.build(submaps(), placed);
  print("grown", map, error(map.placements));
  EXPECT_EQ(map.placements.at(front3_).map_from_submap.size(), whole.submap.keyframes.size());
  EXPECT_LT(error(map.placements).rmse, 0.04);
}

TEST_F(MapBuilderTest, AMemberThatDisappears) {
  MapBuilder builder({});
  builder.find_links(submaps());
  const Placements placed = builder.build(submaps(), {}).placements;
  for (const SubmapKey& gone : {back2_, front3_, front1_}) {
    auto left = submaps();
    left.erase(gone);
    builder.find_links(left);
    const BuiltMap map = builder.build(left, placed);
    EXPECT_FALSE(map.placements.contains(gone));
    EXPECT_EQ(map.placements.size(), 4u);  // what was placed stays placed
    EXPECT_LT(error(map.placements).rmse, 0.04);
    MapBuilder fresh({});
    fresh.find_links(left);
    EXPECT_LT(fresh.build(left, {}).placements.size(), 5u);
  }
}

TEST_F(MapBuilderTest, NumbersThatAreNonePoisonNothing) {
  const std::pair<const char*, std::function<void()>> cases[] = {
      {"landmarks",
       [&] {
         for (auto& [key, made] : made_)
           for (int id = 0; id < 10; ++id) made.submap.landmark(id)->position.setConstant(id % 2 ? NAN : INFINITY);
       }},
      {"shared pose", [&] { made_[back1_].submap.keyframes.at(2).cam_from_submap.translation.setConstant(NAN); }},
      {"lone pose", [&] { made_[back1_].submap.keyframes.at(8).cam_from_submap.translation.setConstant(NAN); }},
      {"first pose of the anchor",
       [&] { made_[front2_].submap.keyframes.at(0).cam_from_submap.rotation.coeffs().setConstant(NAN); }}};
  const auto whole = made_;
  for (const auto& [name, spoil] : cases) {
    made_ = whole;
    spoil();
    MapBuilder builder({});
    builder.find_links(submaps());
    const BuiltMap map = builder.build(submaps(), {});
    std::vector<Eigen::Vector3d> estimate, truth;
    int infinite = 0;
    for (const auto& [key, placement] : map.placements)
      for (const auto& [utime_us, similarity] : placement.map_from_submap) {
        infinite += !similarity.is_finite();
        const Keyframe* keyframe = nullptr;
        for (const auto& [id, k] : made_[key].submap.keyframes)
          if (k.utime_us == utime_us) keyframe = &k;
        const Eigen::Vector3d center = placement.cam_from_map(*keyframe).center();
        if (!center.allFinite()) continue;
        estimate.push_back(center);
        truth.push_back(images_[image_of(utime_us)].cam_from_world.center());
      }
    const PathError e = path_error(estimate, truth);
    std::printf("%s: %zu submaps, %d similarities are no numbers, ATE of the others %.1f mm\n", name,
                map.placements.size(), infinite, 1000 * e.rmse);
    EXPECT_EQ(infinite, 0) << name;
    EXPECT_EQ(map.placements.size(), 5u) << name;
    EXPECT_LT(e.rmse, 0.04) << name;
  }
}

TEST_F(MapBuilderTest, EmptyAndBlindSubmapsDoNoHarm) {
  Submap empty, blind = made_[front2_].submap, unseen = made_[front1_].submap;
  empty.key = {kSession, 8};
  blind.key = {kSession, 9};
  unseen.key = {kSession, 10};
  blind.landmarks.clear();
  for (auto& [id, keyframe] : blind.keyframes) keyframe.landmark_ids.assign(keyframe.landmark_ids.size(), kNone);
  for (auto& [id, landmark] : unseen.landmarks) landmark.observations.clear();
  for (auto& [id, keyframe] : unseen.keyframes) keyframe.landmark_ids.assign(keyframe.landmark_ids.size(), kNone);
  Landmark& lonely = made_[back1_].submap.landmarks[99999];
  lonely.id = 99999;
  lonely.position = {1, 2, 3};
  auto all = submaps();
  all[empty.key] = &empty;
  all[blind.key] = &blind;
  all[unseen.key] = &unseen;
  MapBuilder builder({});
  builder.find_links(all);
  const BuiltMap map = builder.build(all, {});
  EXPECT_EQ(map.placements.size(), 5u);
  EXPECT_TRUE(finite(map.placements));
  EXPECT_LT(error(map.placements).rmse, 0.04);
  EXPECT_TRUE(map.placements.at(back1_).position_in_map(made_[back1_].submap, lonely).allFinite());
  // Placed once, and empty since.
  Placements placed = map.placements;
  placed[empty.key] = {};
  placed[blind.key] = {};
  EXPECT_TRUE(finite(builder.build(all, placed).placements));
  // Nothing but such and a back submap.
  const MapBuilder::Submaps no_front = {{empty.key, &empty}, {back1_, &made_[back1_].submap}};
  EXPECT_TRUE(builder.build(no_front, {{empty.key, {}}, {back1_, {}}}).placements.empty());
  // Nothing but such.
  const MapBuilder::Submaps useless = {{empty.key, &empty}, {blind.key, &blind}};
  EXPECT_TRUE(finite(builder.build(useless, {{empty.key, {}}, {blind.key, {}}}).placements));
}

// Another run of the front, of the same images: what two processes recorded, or a replay into the same map.
TEST_F(MapBuilderTest, TwoSessions) {
  SubmapRecipe other = recipes_[front2_];
  other.key = {kSession + 1, 1};
  other.first = 60;
  other.last = 140;
  other.seed = 99;
  other.distortion = {};
  other.submap_from_world = random_gauge(123);
  made_[other.key] = make_submap(world_, images_, other);
  SubmapRecipe later = other;
  later.key = {kSession + 2, 1};  // elsewhere
  const World elsewhere = make_room(2);
  const auto later_images = film(elsewhere, walk_round(150), {.most_keypoints = 150, .first_utime_us = 50'000'000'000});
  const auto apart = make_submap(elsewhere, later_images, later);
  auto all = submaps();
  all[later.key] = &apart.submap;
  MapBuilder builder({});
  builder.find_links(all);
  const BuiltMap map = builder.build(all, {});
  print("two sessions", map, error(map.placements));
  EXPECT_EQ(map.placements.size(), 6u);
  EXPECT_FALSE(map.placements.contains(later.key));
  EXPECT_LT(error(map.placements).rmse, 0.04);
}

}  // namespace
}  // namespace rumi::testing
