// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/rebuild/model_completion.h"

#include <gmock/gmock.h>

#include "tests/ruminator/test_window.h"

namespace rumi::ruminator {
namespace {

using ::testing::HasSubstr;
using testing::TestWindow;

const Sim3 kElsewhere(2.5, so3_exp({0.1, -0.2, 0.1}), {1, 2, 3});

std::vector<int64_t> utimes_of(const TestWindow& w) {
  std::vector<int64_t> utimes;
  for (size_t i = 0; i < w.images.size(); ++i) utimes.push_back(1000 + 100 * static_cast<int64_t>(i));
  return utimes;
}

// Returns the true poses, with the images from `first` on moved by `elsewhere`.
SparseModel moved_from(const TestWindow& w, int first, const Sim3& elsewhere) {
  SparseModel model = testing::true_model(w);
  model.points.clear();
  for (auto& [image, pose] : model.cam_from_world)
    if (image >= first) pose = elsewhere.transform_camera(pose);
  return model;
}

WindowModel complete(const TestWindow& w, const SparseModel& model, const std::vector<Sample>& front = {}) {
  const std::vector<int64_t> utimes = utimes_of(w);
  const WindowModelInput input{w.camera, w.images, utimes, w.pairs, front};
  const BuildOptions options;
  return ModelCompletion(input, options).complete(model, "model");
}

TEST(ModelCompletion, WhatIsTornOffIsRegrown) {
  TestWindow w = testing::turning_window(16, 6);
  testing::spoil(&w, 0.02, 0.05);
  // In one model they are only moved, in the other they also have another unit.
  for (const double scale : {1.0, 0.3}) {
    const WindowModel candidate =
        complete(w, moved_from(w, 10, Sim3(scale, Eigen::Quaterniond::Identity(), {0, 0, 4})));
    EXPECT_EQ(candidate.model.cam_from_world.size(), w.images.size()) << scale;
    EXPECT_LT(testing::worst_center_error(w, candidate.model), 0.01) << scale;
    EXPECT_THAT(candidate.origin, HasSubstr("regrown")) << scale;
    EXPECT_EQ(candidate.broken_off, 0) << scale;
  }
}

class SplitWindow : public ::testing::Test {
 protected:
  SplitWindow() {
    std::erase_if(w_.pairs, [](const ImagePair& p) { return p.first <= 8 && p.second > 8; });
    testing::spoil(&w_, 0.02, 0.05);
  }
  std::vector<Sample> front(int32_t submap_before, int32_t submap_after) const {
    SyntheticScene random(5);
    std::vector<Sample> samples;
    const std::vector<int64_t> utimes = utimes_of(w_);
    for (int i = 0; i < 16; ++i) {
      if (i >= 7 && i < 10) continue;  // these frames are in the gap
      SE3 pose = Sim3(0.3, so3_exp({0, 1, 0}), {7, 0, 0}).transform_camera(w_.cam_from_world[i]);
      pose.translation += 0.001 * Eigen::Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      samples.push_back(
          {.utime_us = utimes[i], .submap_id = i < 8 ? submap_before : submap_after, .cam_from_submap = pose});
    }
    return samples;
  }

  TestWindow w_ = testing::sideways_window(16);
  SparseModel split_ = moved_from(w_, 9, kElsewhere);
};

TEST_F(SplitWindow, IsJoinedByASubmapOnBothSides) {
  const WindowModel candidate = complete(w_, split_, front(4, 4));
  EXPECT_EQ(candidate.model.cam_from_world.size(), 16U);
  EXPECT_LT(testing::worst_center_error(w_, candidate.model), 0.02);
  EXPECT_THAT(candidate.origin, HasSubstr("joined by front poses"));
  EXPECT_EQ(candidate.broken_off, 0);
  EXPECT_LT(candidate.quality.rmse_px, 1.3);
}

TEST_F(SplitWindow, IsItsLargerSideWhereNothingJoinsIt) {
  for (const std::vector<Sample>& samples : {front(4, 5), {}}) {
    const WindowModel candidate = complete(w_, split_, samples);
    EXPECT_EQ(candidate.model.cam_from_world.size(), 9U);
    EXPECT_EQ(candidate.broken_off, 7);
    EXPECT_THAT(candidate.origin, HasSubstr("7 unrelated images left out"));
  }
}

// Each half of the model agrees with the front submap, but in different units. Many points across the middle prove that
// the model has only one unit.
TEST(ModelCompletion, AFrontSubmapThatSlippedChangesNothing) {
  TestWindow w = testing::sideways_window(16);
  testing::spoil(&w, 0.02, 0.05);
  std::vector<Sample> front;
  for (int i = 0; i < 16; ++i) {
    const double slipped = i < 8 ? 1.0 : 2.0;
    front.push_back(
        {.utime_us = utimes_of(w)[i],
         .submap_id = 4,
         .cam_from_submap = Sim3(slipped, so3_exp({0, 0, 0}), {0, 0, 0}).transform_camera(w.cam_from_world[i])});
  }
  const WindowModel candidate = complete(w, moved_from(w, 16, Sim3()), front);
  EXPECT_EQ(candidate.model.cam_from_world.size(), 16U);
  EXPECT_LT(testing::worst_center_error(w, candidate.model), 0.01);
  EXPECT_EQ(candidate.origin, "model");
}

TEST(ModelCompletion, JoinsTwoModelsThatSeeTheSame) {
  TestWindow w = testing::sideways_window(14, 0.7, 800);
  testing::spoil(&w, 0.05, 0.1);
  const std::vector<int64_t> utimes = utimes_of(w);
  const WindowModelInput input{w.camera, w.images, utimes, w.pairs, {}};
  const BuildOptions options;
  const ModelCompletion completion(input, options);
  SparseModel a = testing::true_model(w), b = testing::true_model(w);
  for (SparseModel* model : {&a, &b}) {
    std::set<int> others;
    for (int image = 0; image < 14; ++image)
      if ((image <= 6) != (model == &a)) others.insert(image);
    remove_images(others, model);
  }
  for (auto& [image, pose] : b.cam_from_world) pose = kElsewhere.transform_camera(pose);
  for (SparseModel::Point& point : b.points) point.position = kElsewhere * point.position;
  const std::vector<SparseModel> joined = completion.joined({a, b});
  ASSERT_EQ(joined.size(), 1U);
  const WindowModel candidate = completion.complete(joined[0], "COLMAP, two models joined");
  EXPECT_EQ(candidate.model.cam_from_world.size(), 14U);
  EXPECT_LT(testing::worst_center_error(w, candidate.model), 0.01);
  EXPECT_TRUE(completion.joined({a}).empty());
  EXPECT_TRUE(completion.joined({a, a}).empty()) << "nothing is won";
}

}  // namespace
}  // namespace rumi::ruminator
