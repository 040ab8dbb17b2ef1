// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/merging/map_part.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "map_server/model/covisible_pieces.h"
#include "map_server/model/point_cells.h"
#include "tests/map_server/synthetic_submaps.h"

namespace rumi::testing {
using namespace rumi::map_server;
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// Ten submaps in a row, with ten keyframes each.
class MapPartTest : public ::testing::Test {
 protected:
  MapPartTest() {
    for (int id = 1; id <= 10; ++id) {
      Submap& submap = made_[id];
      submap.key = key(id);
      for (int k = 0; k < 10; ++k) submap.keyframes[k].id = k;
      submaps_[submap.key] = &submap;
      members_.insert(submap.key);
      if (id > 1) contacts_.insert({key(id - 1), key(id)});
    }
  }
  static SubmapKey key(int id) { return {1, id}; }
  MapPart around(std::set<SubmapKey> fresh, int keyframes) const {
    return part_around(fresh, members_, contacts_, submaps_, keyframes);
  }

  std::map<int, Submap> made_;
  Submaps submaps_;
  std::set<SubmapKey> members_;
  SubmapPairs contacts_;
};

TEST_F(MapPartTest, ASmallMapIsLookedAtAsAWhole) {
  const MapPart part = around({key(10)}, 100);
  EXPECT_EQ(part.submaps, members_);
  EXPECT_THAT(part.fixed, IsEmpty());
}

TEST_F(MapPartTest, OfALargeOneWhatIsAroundAndItsEdgeIsHeld) {
  const MapPart part = around({key(10)}, 35);
  EXPECT_THAT(part.submaps, ElementsAre(key(7), key(8), key(9), key(10)));
  EXPECT_THAT(part.fixed, ElementsAre(key(7)));
  const MapPart middle = around({key(5)}, 30);
  EXPECT_THAT(middle.submaps, ElementsAre(key(4), key(5), key(6)));
  EXPECT_THAT(middle.fixed, ElementsAre(key(4), key(6)));
}

TEST_F(MapPartTest, WhateverTouchesWhatIsNewIsInItHoweverLarge) {
  contacts_.insert({key(1), key(10)});
  contacts_.insert({key(5), key(10)});
  const MapPart part = around({key(10)}, 1);
  EXPECT_THAT(part.submaps, ElementsAre(key(1), key(5), key(9), key(10)));
  EXPECT_THAT(part.fixed, ElementsAre(key(1), key(5), key(9)));
}

TEST_F(MapPartTest, WhatIsNotInTheMapDoesNotCount) {
  members_.erase(key(9));
  const MapPart part = around({key(10)}, 100);
  EXPECT_THAT(part.submaps, ElementsAre(key(10)));
  EXPECT_THAT(part.fixed, IsEmpty());
}

class PieceTest : public ::testing::Test {
 protected:
  PieceTest() : world_(make_room(1)), images_(film(world_, walk_round(60, 1), {.most_keypoints = 100})) {
    SubmapRecipe recipe{.last = 59, .keyframe_every = 1};
    recipe.wrong_landmarks = 0.05;
    made_ = make_submap(world_, images_, recipe);
    model_ = join({{made_.submap.key, truly_placed(made_)}}, 1);
  }
  World world_;
  std::vector<Image> images_;
  SyntheticSubmap made_;
  MapModel model_;
};

TEST_F(PieceTest, EveryViewIsInOnePiece) {
  std::vector<int> views;
  for (int v = 0; v < 60; ++v)
    if (v != 7) views.push_back(v);
  for (const int first : {20, 10}) {
    const auto pieces = covisible_pieces(model_, views, 20, first);
    ASSERT_EQ(pieces.front().size(), static_cast<size_t>(first));
    std::multiset<int> all;
    for (const auto& piece : pieces) {
      EXPECT_LE(piece.size(), 20u);
      all.insert(piece.begin(), piece.end());
    }
    EXPECT_EQ(all, std::multiset<int>(views.begin(), views.end()));
  }
}

TEST_F(PieceTest, APieceIsOfViewsThatSeeTheSame) {
  // If two walks take the same way, a piece contains the same part of both walks, not one whole walk.
  MapModel twice = model_;
  const int n = static_cast<int>(model_.views.size());
  for (int v = 0; v < n; ++v) {
    MapModel::View view = model_.views[v];
    std::fill(view.points.begin(), view.points.end(), kNone);
    twice.views.push_back(view);
    for (size_t k = 0; k < view.points.size(); ++k)
      if (model_.views[v].points[k] != kNone) twice.observe(model_.views[v].points[k], n + v, static_cast<int>(k));
  }
  std::vector<int> views(2 * n);
  std::iota(views.begin(), views.end(), 0);
  const auto pieces = covisible_pieces(twice, views, 40, 40);
  ASSERT_EQ(pieces.size(), 3u);
  const auto has_twin = [&](int view) {
    return std::count(pieces[0].begin(), pieces[0].end(), view < n ? view + n : view - n) == 1;
  };
  EXPECT_GE(std::count_if(pieces[0].begin(), pieces[0].end(), has_twin), 36);
}

TEST_F(PieceTest, ViewsThatShareNothingAreNotOnePiece) {
  for (int v = 30; v < 60; ++v)
    for (int point : std::vector<int>(model_.views[v].points))
      if (point != kNone) model_.forget(point, v);
  std::vector<int> views(60);
  std::iota(views.begin(), views.end(), 0);
  const auto pieces = covisible_pieces(model_, views, 60, 60);
  ASSERT_EQ(pieces.size(), 31u);
  EXPECT_EQ(pieces[0].size(), 30u);
}

// The cells must offer every point that a view sees, and must not offer most of the others.
TEST_F(PieceTest, CellsHoldWhatAViewSees) {
  const double kReach = 2.5;
  model_.points[3].position.setConstant(std::nan(""));
  model_.points[4].position.setConstant(1e300);
  std::vector<double> reach(model_.points.size(), kReach);
  reach[5] = 1e9;
  reach[6] = 0;
  const PointCells cells(model_.points, reach);
  size_t seen = 0, offered = 0;
  for (const MapModel::View& view : model_.views) {
    const std::vector<int> some = cells.may_be_seen(view);
    EXPECT_TRUE(std::is_sorted(some.begin(), some.end()));
    EXPECT_EQ(std::adjacent_find(some.begin(), some.end()), some.end());
    const std::set<int> offer(some.begin(), some.end());
    offered += offer.size();
    for (int p = 0; p < static_cast<int>(model_.points.size()); ++p) {
      const Eigen::Vector3d in_cam = view.cam_from_map * model_.points[p].position;
      if (!(in_cam.z() > 0) || !(in_cam.norm() <= reach[p])) continue;
      if (!view.camera.contains(view.camera.project_undistorted(in_cam))) continue;
      ++seen;
      EXPECT_TRUE(offer.contains(p)) << p;
    }
    EXPECT_FALSE(offer.contains(3));
    EXPECT_FALSE(offer.contains(6));
  }
  EXPECT_GT(seen, 1000u);
  EXPECT_LT(offered, 60 * model_.points.size() / 3);
}

}  // namespace
}  // namespace rumi::testing
