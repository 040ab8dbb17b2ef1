// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/model/global_model.h"

#include <gtest/gtest.h>

#include "ruminator/matching/sift_matching.h"
#include "ruminator/model/model_refinement.h"
#include "tests/ruminator/test_window.h"

namespace rumi::ruminator {
namespace {

using testing::TestWindow;

std::vector<RelativeRotation> rotations_of(const TestWindow& w) {
  return relative_rotations(w.camera, w.images, w.pairs);
}

std::optional<SparseModel> rough_model(const TestWindow& w) {
  return build_global_model(w.camera, w.images, rotations_of(w));
}

// Keeps the matches that pass the verification.
void verify(TestWindow* w) {
  std::vector<SiftFeatures> features(w->images.size());
  for (size_t i = 0; i < features.size(); ++i) features[i].undistorted = w->images[i].keypoints;
  for (ImagePair& pair : w->pairs)
    pair.matches = verify_matches(w->camera, features[pair.first], features[pair.second], pair.matches);
  std::erase_if(w->pairs, [](const ImagePair& pair) { return pair.matches.empty(); });
}

// Adjusts in steps, as is done with rough models.
ModelQuality adjust(const TestWindow& w, SparseModel* model) {
  ModelRefinementOptions options;
  for (const double max_error_px : {50.0, 10.0, 3.0}) {
    options.max_error_px = max_error_px;
    prune_model(w.camera, w.images, options, model);
    adjust_model(w.camera, w.images, options, model);
  }
  return adjust_model(w.camera, w.images, options, model);
}

void expect_truth(const TestWindow& w, double max_error) {
  auto model = rough_model(w);
  ASSERT_TRUE(model);
  EXPECT_EQ(model->fx, w.camera.fx);
  EXPECT_EQ(model->fy, w.camera.fy);
  for (const SparseModel::Point& point : model->points) EXPECT_FALSE(testing::sees_an_image_twice(point.track));
  const ModelQuality quality = adjust(w, &*model);
  EXPECT_EQ(model->cam_from_world.size(), w.images.size());
  EXPECT_LT(quality.rmse_px, 1.3);  // the noise is 0.7 px on each axis
  EXPECT_LT(testing::worst_center_error(w, *model), max_error);
}

TEST(GlobalModel, OfASidewaysPath) { expect_truth(testing::sideways_window(20), 0.01); }

TEST(GlobalModel, OfAFastTurn) { expect_truth(testing::turning_window(20), 0.01); }

TEST(GlobalModel, DespiteWrongMatchesOnASidewaysPath) {
  TestWindow w = testing::sideways_window(20);
  testing::spoil(&w, 0.3, 0);
  verify(&w);
  expect_truth(w, 0.01);
}

TEST(GlobalModel, DespiteWrongMatchesInAFastTurn) {
  TestWindow w = testing::turning_window(20);
  testing::spoil(&w, 0.3, 0);
  verify(&w);
  expect_truth(w, 0.01);
}

TEST(GlobalModel, DespiteWrongPairs) {
  TestWindow w = testing::turning_window(20, 8);
  testing::spoil(&w, 0.05, 0.3);
  expect_truth(w, 0.01);
}

TEST(GlobalModel, IsTheSameEveryTime) {
  TestWindow w = testing::turning_window(8);
  testing::spoil(&w, 0.3, 0);
  const auto once = rough_model(w), again = rough_model(w);
  ASSERT_TRUE(once && again);
  EXPECT_TRUE(testing::is_identical(*once, *again));
}

TEST(GlobalModel, NeedsThreeImagesThatHangTogether) {
  EXPECT_FALSE(build_global_model(test_camera(), {}, {}));
  EXPECT_FALSE(rough_model(testing::sideways_window(1)));
  EXPECT_FALSE(rough_model(testing::sideways_window(2)));
  TestWindow unmatched = testing::sideways_window(4);
  unmatched.pairs.clear();
  EXPECT_FALSE(rough_model(unmatched));
  TestWindow couples = testing::sideways_window(4);
  std::erase_if(couples.pairs, [](const ImagePair& p) { return p.first / 2 != p.second / 2; });
  EXPECT_FALSE(rough_model(couples));
}

TEST(GlobalModel, IsOfTheLargestPart) {
  TestWindow w = testing::sideways_window(8);
  std::erase_if(w.pairs, [](const ImagePair& p) { return (p.first < 3) != (p.second < 3); });
  const auto model = rough_model(w);
  ASSERT_TRUE(model);
  EXPECT_EQ(model->cam_from_world.size(), 5U);
  EXPECT_TRUE(model->cam_from_world.contains(7));
}

TEST(RelativeRotations, AreThoseOfTheTruth) {
  TestWindow w = testing::turning_window(10);
  testing::spoil(&w, 0.3, 0);
  const auto rotations = rotations_of(w);
  EXPECT_GT(rotations.size(), 0.9 * static_cast<double>(w.pairs.size()));
  EXPECT_LT(median_rotation_error_deg(rotations, testing::true_model(w)), 0.5);
}

TEST(RelativeRotations, NeedEnoughMatches) {
  TestWindow w = testing::sideways_window(3);
  w.pairs[0].matches.resize(19);
  w.pairs[1].matches.clear();
  const auto rotations = relative_rotations(w.camera, w.images, w.pairs);
  ASSERT_EQ(rotations.size(), 1U);
  EXPECT_EQ(rotations[0].first, 1);
  EXPECT_EQ(rotations[0].second, 2);
  EXPECT_EQ(rotations[0].pair, &w.pairs[2]);
}

TEST(RelativeRotations, OfPointsThatCoincideAreNoneOrFinite) {
  TestWindow w = testing::sideways_window(3);
  for (WindowImage& image : w.images)
    for (Eigen::Vector2f& keypoint : image.keypoints) keypoint = {320, 240};
  for (const RelativeRotation& r : rotations_of(w)) EXPECT_TRUE(r.second_from_first.coeffs().allFinite());
}

// Two equal images: the direction of the translation is arbitrary, and the rotation is the identity.
TEST(GlobalModel, SurvivesDuplicatedImages) {
  std::vector<SE3> path = testing::sideways_path(10);
  for (const int i : {3, 6}) path[i] = path[i - 1];
  expect_truth(testing::make_window(path, SyntheticScene(7).cloud(500), 0.7), 0.01);
}

TEST(MedianRotationError, KnowsABentModel) {
  const TestWindow w = testing::sideways_window(10);
  const auto rotations = rotations_of(w);
  SparseModel model = testing::true_model(w);
  EXPECT_LT(median_rotation_error_deg(rotations, model), 0.5);
  // A rotation of the whole model makes no difference.
  const SE3 world_from_other(so3_exp({0.3, -1, 0.2}), Eigen::Vector3d(1, 2, 3));
  for (auto& [image, pose] : model.cam_from_world) pose = pose * world_from_other;
  EXPECT_LT(median_rotation_error_deg(rotations, model), 0.5);
  // Adds rotations that grow along the path by 2 degrees a frame.
  for (auto& [image, pose] : model.cam_from_world)
    pose.rotation = so3_exp({0, 2 * image * M_PI / 180, 0}) * pose.rotation;
  EXPECT_GT(median_rotation_error_deg(rotations, model), 3);
}

TEST(MedianRotationError, OfNothingIsTheWorst) {
  const TestWindow w = testing::sideways_window(3);
  EXPECT_EQ(median_rotation_error_deg({}, testing::true_model(w)), 180);
  EXPECT_EQ(median_rotation_error_deg(rotations_of(w), {}), 180);
  SparseModel one = testing::true_model(w);
  one.cam_from_world.erase(1);
  one.cam_from_world.erase(2);
  EXPECT_EQ(median_rotation_error_deg(rotations_of(w), one), 180);
}

}  // namespace
}  // namespace rumi::ruminator
