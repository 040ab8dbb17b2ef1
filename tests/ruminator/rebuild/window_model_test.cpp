// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/rebuild/window_model.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <map>

#include "tests/ruminator/test_window.h"
#include "tests/support/temporary_folder.h"

namespace rumi::ruminator {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;
using testing::TemporaryFolder;
using testing::TestWindow;

const auto kNoProgress = [](double) {};
constexpr const char* kNoColmap = "/no/such/colmap";

std::vector<int64_t> utimes_of(const TestWindow& w) {
  std::vector<int64_t> utimes;
  for (size_t i = 0; i < w.images.size(); ++i) utimes.push_back(1000 + 100 * static_cast<int64_t>(i));
  return utimes;
}

WindowModelResult build(const TestWindow& w, const BuildOptions& options, const TemporaryFolder& folder,
                        const std::function<void(double)>& progress = kNoProgress,
                        const std::vector<Sample>& front = {}) {
  const std::atomic<bool> never = false;
  return build_window_model({w.camera, w.images, utimes_of(w), w.pairs, front}, options, folder.path(), progress,
                            never);
}

BuildOptions without_colmap() {
  BuildOptions options;
  options.colmap = kNoColmap;
  return options;
}

bool is_missing(const WindowModelResult& result) {
  return result.warning.find("not found in PATH") != std::string::npos;
}

TestWindow window_with_outliers() {
  TestWindow w = testing::turning_window(12, 8);
  testing::spoil(&w, 0.02, 0.1);
  return w;
}

TEST(WindowModel, HasEveryImageAtItsPlace) {
  const TestWindow w = window_with_outliers();
  const TemporaryFolder folder;
  std::vector<double> fractions;
  const WindowModelResult result = build(w, {}, folder, [&](double f) { fractions.push_back(f); });
  if (is_missing(result)) GTEST_SKIP() << "SKIPPED: " << result.warning;
  ASSERT_TRUE(result.best) << result.best.error_text();
  EXPECT_EQ(result.warning, "");
  EXPECT_THAT(result.best->origin, StartsWith("global model"));
  EXPECT_EQ(result.best->credible.error_text(), "");
  EXPECT_EQ(result.best->model.cam_from_world.size(), w.images.size());
  EXPECT_LT(result.best->quality.rmse_px, 1.3);
  EXPECT_LT(result.best->pair_rotation_deg, 1);
  EXPECT_LT(testing::worst_center_error(w, result.best->model), 0.01);
  EXPECT_GT(result.child_cpu_s, 0);
  ASSERT_FALSE(fractions.empty());
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));

  const TemporaryFolder other;
  const WindowModelResult again = build(w, {}, other);
  EXPECT_TRUE(testing::is_identical(again.best->model, result.best->model));
  EXPECT_EQ(again.best->origin, result.best->origin);
}

// Displaces a fifth of the keypoints by which the images before `first` are matched with the others.
void blur_from(int first, TestWindow* w) {
  std::map<std::pair<int, int>, int> wrong;  // index of the displaced keypoint, by image and keypoint
  for (ImagePair& pair : w->pairs) {
    if (pair.first >= first || pair.second < first) continue;
    std::vector<Eigen::Vector2f>& keypoints = w->images[pair.first].keypoints;
    for (auto& [a, b] : pair.matches) {
      const int point = w->point_of_keypoint[pair.first][a];
      if (point % 5 != 0) continue;
      const auto [elsewhere, is_new] = wrong.try_emplace({pair.first, a}, static_cast<int>(keypoints.size()));
      if (is_new) keypoints.push_back(keypoints[a] + Eigen::Vector2f(point % 2 ? 14 : -14, point % 3 ? 9 : -9));
      a = elsewhere->second;
    }
  }
}

TEST(WindowModel, IsMoreThanAGapThatNothingJoinsToTheFront) {
  constexpr int kKnown = 6;  // images for which front_tracker has poses
  TestWindow w = testing::sideways_window(18);
  std::erase_if(w.pairs, [](const ImagePair& pair) { return pair.second - pair.first > 3; });
  blur_from(kKnown, &w);
  std::vector<Sample> front;
  for (int i = 0; i < kKnown; ++i) front.push_back({utimes_of(w)[i], true, 1, w.cam_from_world[i]});

  const TemporaryFolder folder;
  const WindowModelResult alone = build(w, without_colmap(), folder);
  ASSERT_TRUE(alone.best) << alone.best.error_text();
  EXPECT_EQ(alone.best->broken_off, kKnown) << "front_tracker knows nothing: the larger part will do";
  const TemporaryFolder other;
  const WindowModelResult joined = build(w, without_colmap(), other, kNoProgress, front);
  ASSERT_TRUE(joined.best) << joined.best.error_text();
  EXPECT_EQ(joined.best->model.cam_from_world.size(), w.images.size());
  EXPECT_LT(testing::worst_center_error(w, joined.best->model), 0.01);
  ASSERT_EQ(joined.best->agreement.size(), 1u);
  EXPECT_EQ(joined.best->agreement[0].frames, kKnown);
  EXPECT_GT(joined.attempts, alone.attempts);
}

TEST(WindowModel, IsTheGlobalOneWithoutColmap) {
  const TestWindow w = window_with_outliers();
  const TemporaryFolder folder;
  const WindowModelResult result = build(w, without_colmap(), folder);
  ASSERT_TRUE(result.best) << result.best.error_text();
  EXPECT_THAT(result.warning, HasSubstr(kNoColmap));
  EXPECT_EQ(result.best->origin, "global model");
  EXPECT_EQ(result.best->model.cam_from_world.size(), w.images.size());
  EXPECT_LT(testing::worst_center_error(w, result.best->model), 0.01);
  EXPECT_EQ(result.child_cpu_s, 0);
}

// If COLMAP ends with an error, the global model must not be lost either.
// A window by place without COLMAP, of which the map knows the first half: `moved` is how far wrong, in radians.
WindowModelResult build_by_place(const TestWindow& w, int known, double moved) {
  const std::vector<int64_t> utimes_us = utimes_of(w);
  std::vector<Sample> front;
  for (int i = 0; i < known; ++i) {
    const SE3 wrong = SE3::exp((Vector6d() << 0, 0, 0, 0, moved * (i % 2), 0).finished());
    front.push_back({utimes_us[i], true, kMapFrame, wrong * w.cam_from_world[i]});
  }
  const TemporaryFolder folder;
  const std::atomic<bool> never = false;
  return build_window_model({w.camera, w.images, utimes_us, w.pairs, front, true}, without_colmap(), folder.path(),
                            kNoProgress, never);
}

TEST(WindowModel, ByPlaceGrowsOutOfTheMap) {
  const TestWindow w = window_with_outliers();
  const WindowModelResult result = build_by_place(w, 6, 0);
  ASSERT_TRUE(result.best) << result.best.error_text();
  EXPECT_EQ(result.best->model.cam_from_world.size(), w.images.size());
  EXPECT_LT(testing::worst_center_error(w, result.best->model), 0.01);
}

TEST(WindowModel, ByPlaceNeedsAWitness) {
  EXPECT_THAT(build_by_place(window_with_outliers(), 0, 0).best.error_text(),
              HasSubstr("the only model, global model, has no witness"));
}

TEST(WindowModel, NeedsAWitnessWhereTheFrontKnowsLessThanHalf) {
  const TestWindow w = window_with_outliers();
  const std::vector<int64_t> utimes_us = utimes_of(w);
  const auto needs = [&](size_t known, bool by_place) {
    std::vector<Sample> front;
    for (size_t i = 0; i < known; ++i) front.push_back({utimes_us[i], true, 1, w.cam_from_world[i]});
    return WindowModelInput{w.camera, w.images, utimes_us, w.pairs, front, by_place}.needs_witness();
  };
  ASSERT_EQ(w.images.size(), 12u);
  EXPECT_TRUE(needs(0, false));
  EXPECT_TRUE(needs(5, false));
  EXPECT_FALSE(needs(6, false));
  EXPECT_TRUE(needs(12, true));
}

TEST(WindowModel, ByPlaceMendsTheMap) {
  const TestWindow w = window_with_outliers();
  const WindowModelResult result = build_by_place(w, 6, 0.5);
  ASSERT_TRUE(result.best) << result.best.error_text();
  EXPECT_LT(testing::worst_center_error(w, result.best->model), 0.01);
}

TEST(WindowModel, SurvivesAColmapThatFails) {
  const TestWindow w = window_with_outliers();
  const TemporaryFolder folder;
  BuildOptions options;
  options.colmap = "false";
  const WindowModelResult result = build(w, options, folder);
  EXPECT_TRUE(result.best) << result.best.error_text();
  EXPECT_NE(result.warning, "");
}

TEST(WindowModel, IsColmapsWhereThereIsNoGlobalOne) {
  const TestWindow w = window_with_outliers();
  const TemporaryFolder folder;
  BuildOptions options;
  options.global_track_images = 1000;
  const WindowModelResult result = build(w, options, folder);
  if (is_missing(result)) GTEST_SKIP() << "SKIPPED: " << result.warning;
  ASSERT_TRUE(result.best) << result.best.error_text();
  EXPECT_THAT(result.best->origin, StartsWith("COLMAP, first pair at"));
  EXPECT_EQ(result.best->model.cam_from_world.size(), w.images.size());
  EXPECT_LT(testing::worst_center_error(w, result.best->model), 0.01);
}

TEST(WindowModel, WithoutColmapAndGlobalModelMayComeLater) {
  TestWindow w = testing::sideways_window(2);
  const TemporaryFolder folder;
  const WindowModelResult result = build(w, without_colmap(), folder);
  EXPECT_THAT(result.best.error_text(), HasSubstr(kNoColmap));
  EXPECT_TRUE(result.retryable);
}

TEST(WindowModel, OfNothingIsAFailureWithAReason) {
  for (const int images : {0, 1, 5}) {
    TestWindow w = testing::sideways_window(images);
    w.pairs.clear();
    const TemporaryFolder folder;
    const WindowModelResult result = build(w, {}, folder);
    EXPECT_NE(result.best.error_text(), "") << images;
  }
}

TEST(WindowModel, OfAPureRotationIsRefused) {
  std::vector<SE3> path;
  for (int i = 0; i < 8; ++i) path.push_back(SyntheticScene::pose(0, 0, 0, 0.05 * i));
  const TestWindow w = testing::make_window(path, SyntheticScene(7).cloud(400), 0.7);
  const TemporaryFolder folder;
  EXPECT_FALSE(build(w, without_colmap(), folder).best);
}

TEST(WindowModel, RefusedForItsErrorSaysSo) {
  const TestWindow w = window_with_outliers();
  const TemporaryFolder folder;
  BuildOptions options = without_colmap();
  options.max_rmse_px = 0.1;
  const WindowModelResult result = build(w, options, folder);
  EXPECT_THAT(result.best.error_text(), HasSubstr("no credible model in"));
  EXPECT_THAT(result.best.error_text(), HasSubstr("global model (12 of 12 images): reprojection error"));
}

TEST(WindowModel, CanBeCancelledAtAnyPoint) {
  const TestWindow w = window_with_outliers();
  BuildOptions options;
  options.max_rmse_px = 0.1;  // so that no attempt is good enough
  for (int calls = 0; calls < 4; ++calls) {
    const TemporaryFolder folder;
    std::atomic<bool> cancel = calls == 0;
    int called = 0;
    const auto progress = [&](double) { cancel = cancel || ++called == calls; };
    const WindowModelResult result =
        build_window_model({w.camera, w.images, utimes_of(w), w.pairs, {}}, options, folder.path(), progress, cancel);
    EXPECT_TRUE(result.cancelled) << calls;
    EXPECT_EQ(result.best.error_text(), "cancelled");
  }
}

TEST(WindowModel, SaysWhereItCannotWrite) {
  const TestWindow w = testing::sideways_window(4);
  const std::atomic<bool> never = false;
  const WindowModelResult result =
      build_window_model({w.camera, w.images, utimes_of(w), w.pairs, {}}, {}, "/proc/nothing", kNoProgress, never);
  EXPECT_THAT(result.best.error_text(), HasSubstr("/proc/nothing/database.db"));
  EXPECT_TRUE(result.retryable);
}

class Judge : public ::testing::Test {
 protected:
  WindowModel judged(const SparseModel& model, double rmse_px = 1, const std::vector<Sample>& front = {}) const {
    const std::vector<int64_t> utimes = utimes_of(w_);
    WindowModel candidate;
    candidate.model = model;
    candidate.quality.rmse_px = rmse_px;
    candidate.credible = Error{"an old doubt"};
    judge_model({w_.camera, w_.images, utimes, w_.pairs, front}, relative_rotations(w_.camera, w_.images, w_.pairs), {},
                &candidate);
    return candidate;
  }

  TestWindow w_ = testing::sideways_window(12);
  SparseModel truth_ = testing::true_model(w_);
};

TEST_F(Judge, AcceptsTheTruthHoweverItIsTurnedAndScaled) {
  EXPECT_EQ(judged(truth_).credible.error_text(), "");
  const Sim3 other_from_world(3, so3_exp({1, 2, 0.5}), {4, 5, 6});
  for (auto& [image, pose] : truth_.cam_from_world) pose = other_from_world.transform_camera(pose);
  const WindowModel candidate = judged(truth_);
  EXPECT_EQ(candidate.credible.error_text(), "");
  EXPECT_LT(candidate.pair_rotation_deg, 0.5);
}

TEST_F(Judge, RefusesAFoldInTheMiddle) {
  const Sim3 fold(1, so3_exp({0, 10 * M_PI / 180, 0}), Eigen::Vector3d::Zero());
  for (auto& [image, pose] : truth_.cam_from_world)
    if (image >= 6) pose = fold.transform_camera(pose);
  EXPECT_THAT(judged(truth_).credible.error_text(), HasSubstr("rotations differ"));
}

// The generalized bas-relief ambiguity: motion to the side is taken for a rotation.
TEST_F(Judge, RefusesATurnThatGrowsAlongThePath) {
  for (auto& [image, pose] : truth_.cam_from_world)
    pose = SE3(so3_exp({0, 1.5 * image * M_PI / 180, 0}) * pose.rotation, pose.translation);
  const WindowModel candidate = judged(truth_);
  EXPECT_GT(candidate.pair_rotation_deg, 3);
  EXPECT_THAT(candidate.credible.error_text(), HasSubstr("rotations differ"));
}

TEST_F(Judge, RefusesALargeErrorAndTooFewImages) {
  EXPECT_THAT(judged(truth_, 1.6).credible.error_text(), HasSubstr("reprojection error 1.60 px"));
  EXPECT_EQ(judged(SparseModel()).credible.error_text(), "0 images have a pose");
  while (truth_.cam_from_world.size() > 2) truth_.cam_from_world.erase(truth_.cam_from_world.begin());
  EXPECT_EQ(judged(truth_).credible.error_text(), "2 images have a pose");
}

TEST_F(Judge, ARivalMayAddImagesButNotContradict) {
  const std::vector<int64_t> utimes = utimes_of(w_);
  SparseModel part = truth_;
  for (const int image : {0, 1, 11}) part.cam_from_world.erase(image);
  SparseModel rival = truth_;
  const Sim3 other_from_world(3, so3_exp({1, 2, 0.5}), {4, 5, 6});
  for (auto& [image, pose] : rival.cam_from_world) pose = other_from_world.transform_camera(pose);
  EXPECT_EQ(compare_shapes(part, rival, utimes, {}).error_text(), "");
  for (auto& [image, pose] : rival.cam_from_world)  // half of them at twice the scale; the rotations stay right
    if (image >= 6) pose.translation -= pose.rotation * (pose.center() - rival.cam_from_world.at(5).center());
  EXPECT_THAT(compare_shapes(part, rival, utimes, {}).error_text(), HasSubstr("positions differ"));
  while (part.cam_from_world.size() > 2) part.cam_from_world.erase(part.cam_from_world.begin());
  EXPECT_EQ(compare_shapes(part, rival, utimes, {}).error_text(), "") << "too little to compare";
}

TEST_F(Judge, ComparesWithFrontTracker) {
  std::vector<Sample> front;
  for (int i = 0; i < 6; ++i)
    front.push_back({.utime_us = 1000 + 100 * i, .submap_id = 4, .cam_from_submap = w_.cam_from_world[i]});
  const WindowModel candidate = judged(truth_, 1, front);
  ASSERT_EQ(candidate.agreement.size(), 1U);
  EXPECT_EQ(candidate.agreement[0].submap_id, 4);
  EXPECT_EQ(candidate.agreement[0].frames, 6);
  EXPECT_NEAR(candidate.agreement[0].rotation_deg, 0, 1e-5);
}

}  // namespace
}  // namespace rumi::ruminator
