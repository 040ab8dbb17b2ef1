// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/model/model_joining.h"

#include <gtest/gtest.h>

#include "ruminator/model/model_refinement.h"
#include "tests/ruminator/test_window.h"

namespace rumi::ruminator {
namespace {

using testing::TestWindow;

const Sim3 kElsewhere(2.5, so3_exp({0.3, -0.5, 0.2}), {1, 2, 3});

// Returns the images first..last with their true poses, and the points that they see, moved and scaled.
SparseModel part(const TestWindow& w, int first, int last, const Sim3& part_from_world = Sim3()) {
  SparseModel model;
  for (int image = first; image <= last; ++image)
    model.cam_from_world[image] = part_from_world.transform_camera(w.cam_from_world[image]);
  triangulate_tracks(w.camera, w.images, join_tracks(w.images, w.pairs), {}, &model);
  return model;
}

std::optional<Sim3> align(const TestWindow& w, const SparseModel& a, const SparseModel& b) {
  return align_models(w.camera, w.images, join_tracks(w.images, w.pairs), a, b);
}

TEST(AlignModels, FindsWhatBothSee) {
  TestWindow w = testing::sideways_window(14, 0.7, 800);
  testing::spoil(&w, 0.05, 0.1);
  // The models have no image in common, or two, or four.
  for (const auto& [first, last] : {std::pair(7, 13), std::pair(5, 13), std::pair(3, 13)}) {
    const SparseModel a = part(w, 0, 6), b = part(w, first, last, kElsewhere);
    const auto a_from_b = align(w, a, b);
    ASSERT_TRUE(a_from_b) << first;
    EXPECT_NEAR(a_from_b->scale * kElsewhere.scale, 1, 0.05) << first;
    const SparseModel joined = join_models(*a_from_b, a, b);
    EXPECT_EQ(joined.cam_from_world.size(), static_cast<size_t>(std::max(last, 6) + 1));
    EXPECT_LT(testing::worst_center_error(w, joined), 0.03) << first;
    for (int image = 0; image <= 6; ++image)
      EXPECT_EQ(joined.cam_from_world.at(image).translation, a.cam_from_world.at(image).translation);
  }
}

TEST(AlignModels, IsTheSameEveryTime) {
  const TestWindow w = testing::sideways_window(10);
  const SparseModel a = part(w, 0, 4), b = part(w, 5, 9, kElsewhere);
  EXPECT_EQ(align(w, a, b)->translation, align(w, a, b)->translation);
}

TEST(AlignModels, NotWhatHasNothingInCommon) {
  TestWindow w = testing::sideways_window(12);
  std::erase_if(w.pairs, [](const ImagePair& p) { return p.first <= 5 && p.second > 5; });
  EXPECT_FALSE(align(w, part(w, 0, 5), part(w, 6, 11)));
  EXPECT_FALSE(align(w, part(w, 0, 5), {}));
}

TEST(AlignModels, NotByWrongMatches) {
  TestWindow w = testing::sideways_window(12);
  TestWindow wrong = w;
  testing::spoil(&wrong, 0.9, 0);
  for (size_t p = 0; p < w.pairs.size(); ++p)
    if (w.pairs[p].first <= 5 && w.pairs[p].second > 5) w.pairs[p] = wrong.pairs[p];
  EXPECT_FALSE(align(w, part(w, 0, 5), part(w, 6, 11)));
}

class FrontTie : public ::testing::Test {
 protected:
  FrontTie() {
    for (int i = 0; i < 16; ++i) utimes_.push_back(1000 + i);
  }
  std::vector<Sample> front(int32_t submap_before, int32_t submap_after) const {
    std::vector<Sample> samples;
    for (int i = 0; i < 16; ++i)
      if (i < 6 || i >= 10)
        samples.push_back(
            {.utime_us = utimes_[i],
             .submap_id = i < 8 ? submap_before : submap_after,
             .cam_from_submap = Sim3(0.3, so3_exp({0, 1, 0}), {7, 0, 0}).transform_camera(w_.cam_from_world[i])});
    return samples;
  }
  std::optional<Sim3> tie(const std::vector<Sample>& front) const {
    return front_tie(front, utimes_, part(w_, 0, 7), part(w_, 8, 15, kElsewhere));
  }

  TestWindow w_ = testing::sideways_window(16);
  std::vector<int64_t> utimes_;
};

TEST_F(FrontTie, IsOneSubmapOnBothSides) {
  const auto before_from_after = tie(front(4, 4));
  ASSERT_TRUE(before_from_after);
  const SparseModel joined = join_models(*before_from_after, part(w_, 0, 7), part(w_, 8, 15, kElsewhere));
  EXPECT_LT(testing::worst_center_error(w_, joined), 1e-6);
}

TEST_F(FrontTie, NotTwoSubmaps) { EXPECT_FALSE(tie(front(4, 5))); }

TEST_F(FrontTie, NotTooFewFrames) {
  std::vector<Sample> samples = front(4, 4);
  samples.resize(10);  // leaves six in one submap and four in the other
  EXPECT_FALSE(tie(samples));
}

TEST_F(FrontTie, NotASubmapOfAnotherShape) {
  std::vector<Sample> samples = front(4, 4);
  for (size_t i = 0; i < 3; ++i) samples[i].cam_from_submap.translation += Eigen::Vector3d(0, 0.2, 0);
  EXPECT_FALSE(tie(samples));
}

}  // namespace
}  // namespace rumi::ruminator
