// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/model/torn_model.h"

#include <gtest/gtest.h>

#include "tests/ruminator/test_window.h"

namespace rumi::ruminator {
namespace {

using testing::TestWindow;

// Makes a torn model: the images from `first` on are moved away, and every point keeps only the observations on the
// side that has more of them.
SparseModel torn_at(const TestWindow& w, int first) {
  SparseModel model = testing::true_model(w);
  for (auto& [image, pose] : model.cam_from_world)
    if (image >= first) pose.translation += Eigen::Vector3d(0, 0, 5);
  for (SparseModel::Point& point : model.points) {
    const auto is_after = [first](const auto& o) { return o.first >= first; };
    const auto after = std::count_if(point.track.begin(), point.track.end(), is_after);
    const bool keep_after = 2 * after > static_cast<long>(point.track.size());
    std::erase_if(point.track, [&](const auto& o) { return is_after(o) != keep_after; });
  }
  std::erase_if(model.points, [](const SparseModel::Point& point) { return point.track.size() < 2; });
  return model;
}

TEST(TornModel, TheTruthIsSoundWithOutliersToo) {
  TestWindow w = testing::sideways_window(12);
  const SparseModel truth = testing::true_model(w);
  for (const PairAgreement& agreement : pair_agreements(w.pairs, truth)) EXPECT_EQ(agreement.severed, 0);
  EXPECT_TRUE(torn_off(pair_agreements(w.pairs, truth), kMaxSevered, truth).empty());
  testing::spoil(&w, 0.05, 0.05);
  EXPECT_TRUE(torn_off(pair_agreements(w.pairs, truth), kMaxSevered, truth).empty());
}

TEST(TornModel, TheSmallerPartIsTornOff) {
  TestWindow w = testing::turning_window(14, 6);
  testing::spoil(&w, 0.02, 0.05);
  for (const int first : {4, 9}) {
    const SparseModel model = torn_at(w, first);
    const std::set<int> off = torn_off(pair_agreements(w.pairs, model), kMaxSevered, model);
    std::set<int> smaller;
    for (int image = 0; image < 14; ++image)
      if ((image >= first) == (first > 7)) smaller.insert(image);
    EXPECT_EQ(off, smaller) << first;
  }
}

TEST(TornModel, AnImageThatSeesOtherThingsIsNotTornOff) {
  const TestWindow w = testing::sideways_window(6);
  SparseModel model = testing::true_model(w);
  std::vector<PairAgreement> agreements;
  for (const PairAgreement& agreement : pair_agreements(w.pairs, model))
    if (agreement.second != 5) agreements.push_back(agreement);
  EXPECT_TRUE(torn_off(agreements, kMaxSevered, model).empty());
}

// Images 0 to 4 have strong matches with each other, and so have 5 to 7.
std::vector<PairAgreement> two_groups() {
  return {{0, 1, 80}, {1, 2, 80}, {2, 3, 80}, {3, 4, 80}, {5, 6, 80}, {6, 7, 80}};
}

SparseModel of_images(int count) {
  SparseModel model;
  for (int image = 0; image < count; ++image) model.cam_from_world[image] = SE3();
  return model;
}

TEST(TornModel, AFewMatchesElsewhereDoNotHoldWhatIsTorn) {
  std::vector<PairAgreement> agreements = two_groups();
  agreements.push_back({4, 5, 8, 47});
  EXPECT_EQ(torn_off(agreements, kMaxSevered, of_images(8)), (std::set<int>{5, 6, 7}));
  agreements.push_back({0, 7, 18, 1});
  EXPECT_EQ(torn_off(agreements, kMaxSevered, of_images(8)), (std::set<int>{5, 6, 7}));
}

TEST(TornModel, ManyPairsTogetherTellATearThatFewMatchesOfAnyOneCross) {
  std::vector<PairAgreement> agreements = two_groups();
  agreements.insert(agreements.end(), {{4, 5, 16, 2}, {3, 5, 14, 6}, {4, 6, 13, 5}, {3, 6, 15, 5}});
  EXPECT_EQ(torn_off(agreements, kMaxSevered, of_images(8)), (std::set<int>{5, 6, 7}));
}

TEST(TornModel, OneSpoiledPairAmongManyIsNoTear) {
  std::vector<PairAgreement> agreements = two_groups();
  agreements.insert(agreements.end(), {{4, 5, 60, 15}, {3, 5, 50, 2}, {4, 6, 70, 3}, {3, 6, 40, 4}});
  EXPECT_TRUE(torn_off(agreements, kMaxSevered, of_images(8)).empty());
}

TEST(TornModel, WhereNoiseSeversEverywhereATearSeversMore) {
  std::vector<PairAgreement> agreements = two_groups();
  for (PairAgreement& agreement : agreements) agreement.severed = 12;
  agreements.push_back({4, 5, 60, 20});
  EXPECT_TRUE(torn_off(agreements, kMaxSevered, of_images(8)).empty());
  agreements.back().severed = 120;
  EXPECT_EQ(torn_off(agreements, kMaxSevered, of_images(8)), (std::set<int>{5, 6, 7}));
}

TEST(TornModel, OfNothingIsNothing) {
  EXPECT_TRUE(pair_agreements({}, {}).empty());
  EXPECT_TRUE(torn_off({}, kMaxSevered, {}).empty());
}

}  // namespace
}  // namespace rumi::ruminator
