// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/model/model_refinement.h"

#include <gtest/gtest.h>

#include "tests/ruminator/test_window.h"

namespace rumi::ruminator {
namespace {

using testing::TestWindow;

constexpr ModelRefinementOptions kOptions;

void disturb(double meters, double radians, SparseModel* model) {
  SyntheticScene random(11);
  const auto vector = [&random](double s) {
    const double x = random.uniform(-s, s), y = random.uniform(-s, s);
    return Eigen::Vector3d(x, y, random.uniform(-s, s));
  };
  for (auto& [image, pose] : model->cam_from_world) {
    const Eigen::Vector3d turn = vector(radians);
    pose = SE3(so3_exp(turn), vector(meters)) * pose;
  }
  for (SparseModel::Point& point : model->points) point.position += vector(meters);
}

TEST(AdjustModel, ComesBackFromARoughStart) {
  const TestWindow w = testing::sideways_window(10);
  SparseModel model = testing::true_model(w);
  disturb(0.03, 0.01, &model);
  ModelRefinementOptions rough;
  rough.max_error_px = 50;
  adjust_model(w.camera, w.images, rough, &model);
  const ModelQuality quality = adjust_model(w.camera, w.images, kOptions, &model);
  EXPECT_EQ(model.cam_from_world.size(), 10U);
  EXPECT_LT(quality.rmse_px, 1.05);
  EXPECT_GT(quality.rmse_px, 0.7);
  EXPECT_LT(testing::worst_center_error(w, model), 0.01);
}

TEST(AdjustModel, RemovesWrongObservations) {
  TestWindow w = testing::sideways_window(10, 0.5);
  SparseModel model = testing::true_model(w);
  std::set<std::pair<int, int>> wrong;
  SyntheticScene random(5);
  for (const SparseModel::Point& point : model.points) {
    if (random.uniform(0, 1) > 0.2) continue;
    const auto& [image, keypoint] = point.track.front();
    w.images[image].keypoints[keypoint] += Eigen::Vector2f(25, -15);
    wrong.insert(point.track.front());
  }
  ASSERT_GT(wrong.size(), 50U);
  const ModelQuality quality = adjust_model(w.camera, w.images, kOptions, &model);
  EXPECT_LT(quality.rmse_px, 0.8);
  int observations = 0;
  for (const SparseModel::Point& point : model.points)
    for (const auto& observation : point.track) {
      EXPECT_FALSE(wrong.contains(observation));
      ++observations;
    }
  EXPECT_EQ(observations, quality.observations);
}

TEST(AdjustModel, OfNothingIsNothing) {
  SparseModel model;
  EXPECT_EQ(adjust_model(test_camera(), {}, kOptions, &model).observations, 0);
  const TestWindow w = testing::sideways_window(3);
  model = testing::true_model(w);
  model.points.clear();
  EXPECT_EQ(adjust_model(w.camera, w.images, kOptions, &model).observations, 0);
  EXPECT_TRUE(model.cam_from_world.empty());
}

// The camera only turns: no point has parallax, so nothing remains.
TEST(PruneModel, LeavesNothingOfAPureRotation) {
  std::vector<SE3> path;
  for (int i = 0; i < 6; ++i) path.push_back(SyntheticScene::pose(0, 0, 0, 0.05 * i));
  const TestWindow w = testing::make_window(path, SyntheticScene(7).cloud(300), 0.5);
  SparseModel model = testing::true_model(w);
  prune_model(w.camera, w.images, kOptions, &model);
  EXPECT_TRUE(model.points.empty());
  EXPECT_TRUE(model.cam_from_world.empty());
}

TEST(PruneModel, KeepsWhatIsRight) {
  const TestWindow w = testing::sideways_window(10, 0);
  SparseModel model = testing::true_model(w);
  const size_t points = model.points.size();
  prune_model(w.camera, w.images, kOptions, &model);
  EXPECT_EQ(model.cam_from_world.size(), 10U);
  EXPECT_GT(static_cast<double>(model.points.size()), 0.9 * static_cast<double>(points));
  EXPECT_LE(model.points.size(), points);
}

TEST(TriangulateTracks, FindsThePointsDespiteWrongMatches) {
  TestWindow w = testing::sideways_window(10);
  testing::spoil(&w, 0.1, 0);
  SparseModel model = testing::true_model(w);
  triangulate_tracks(w.camera, w.images, join_tracks(w.images, w.pairs), kOptions, &model);
  ASSERT_GT(model.points.size(), 200U);
  std::vector<double> errors;
  for (const SparseModel::Point& point : model.points) {
    EXPECT_GE(point.track.size(), 2U);
    EXPECT_FALSE(testing::sees_an_image_twice(point.track));
    const auto& [image, keypoint] = point.track[0];
    const Eigen::Vector3d truth = w.points[w.point_of_keypoint[image][keypoint]];
    errors.push_back((point.position - truth).norm() / truth.norm());
  }
  std::sort(errors.begin(), errors.end());
  EXPECT_LT(errors[errors.size() / 2], 0.03);
}

TEST(TriangulateTracks, LeavesOutImagesWithoutPose) {
  const TestWindow w = testing::sideways_window(6);
  SparseModel model = testing::true_model(w);
  model.cam_from_world.erase(0);
  model.cam_from_world.erase(4);
  triangulate_tracks(w.camera, w.images, join_tracks(w.images, w.pairs), kOptions, &model);
  EXPECT_GT(model.points.size(), 100U);
  for (const SparseModel::Point& point : model.points)
    for (const auto& [image, keypoint] : point.track) EXPECT_TRUE(model.cam_from_world.contains(image));
  model.cam_from_world.clear();
  triangulate_tracks(w.camera, w.images, join_tracks(w.images, w.pairs), kOptions, &model);
  EXPECT_TRUE(model.points.empty());
}

TEST(RemoveLooseImages, LeavesAWellTiedModelAlone) {
  const TestWindow w = testing::sideways_window(8);
  SparseModel model = testing::true_model(w);
  const SparseModel before = model;
  EXPECT_EQ(remove_loose_images(kOptions, &model), 0);
  EXPECT_TRUE(testing::is_identical(model, before));
}

// The last image sees only points that images 0 and 1 see, which are at one place. Wherever it lies along the rays, its
// points fit.
TEST(RemoveLooseImages, RemovesWhatHangsOnOnePlaceOnly) {
  std::vector<SE3> path = testing::sideways_path(7);
  path[1] = path[0];
  const TestWindow w = testing::make_window(path, SyntheticScene(7).cloud(500), 0.7);
  SparseModel model = testing::true_model(w);
  std::vector<SparseModel::Point> split;
  bool tied = false;
  for (const SparseModel::Point& point : model.points) {
    SparseModel::Point loose{point.position, {}}, firm{point.position, {}};
    for (const auto& o : point.track) (o.first < 2 || o.first == 6 ? loose : firm).track.push_back(o);
    // Every second point connects images 0 and 1 with the others.
    if (tied = !tied; tied) {
      std::erase_if(loose.track, [](const auto& o) { return o.first == 6; });
      firm.track.insert(firm.track.begin(), loose.track.begin(), loose.track.end());
      loose.track.clear();
    }
    for (const SparseModel::Point& part : {loose, firm})
      if (part.track.size() >= 2) split.push_back(part);
  }
  model.points = split;
  EXPECT_EQ(remove_loose_images(kOptions, &model), 1);
  EXPECT_FALSE(model.cam_from_world.contains(6));
  EXPECT_EQ(model.cam_from_world.size(), 6U);
  for (const SparseModel::Point& point : model.points) {
    EXPECT_GE(point.track.size(), 2U);
    for (const auto& [image, keypoint] : point.track) EXPECT_NE(image, 6);
  }
}

TEST(RemoveLooseImages, RemovesAllOfThatHoldEachOtherOnly) {
  const TestWindow w = testing::sideways_window(2);
  SparseModel model = testing::true_model(w);
  EXPECT_EQ(remove_loose_images(kOptions, &model), 2);
  EXPECT_TRUE(model.cam_from_world.empty());
  EXPECT_TRUE(model.points.empty());
  EXPECT_EQ(remove_loose_images(kOptions, &model), 0);
}

// In the dark the first and the last three images keep only some points, enough for a pose.
TEST(TrimOpenEnds, GoAsFarAsTheySeeTooLittleAndAreNotKnown) {
  const TestWindow w = testing::sideways_window(12);
  const auto dark = [](int image) { return image == 0 || image > 8; };
  std::map<int, int> seen;
  SparseModel model = testing::true_model(w);
  for (SparseModel::Point& point : model.points)
    std::erase_if(point.track, [&](const auto& o) {
      return dark(o.first) && ++seen[o.first] > kOpenEndFactor * kOptions.resection_min_inliers - 5;
    });
  std::erase_if(model.points, [](const SparseModel::Point& point) { return point.track.size() < 2; });
  EXPECT_EQ(remove_loose_images(kOptions, &model), 0);

  SparseModel first_known = model, last_known = model;
  EXPECT_EQ(trim_open_ends({}, kOptions, &model), 4);
  EXPECT_EQ(model.cam_from_world.begin()->first, 1);
  EXPECT_EQ(model.cam_from_world.rbegin()->first, 8);
  EXPECT_EQ(trim_open_ends({}, kOptions, &model), 0);
  EXPECT_EQ(trim_open_ends({0, 1, 2}, kOptions, &first_known), 3);
  EXPECT_TRUE(first_known.cam_from_world.contains(0));
  EXPECT_EQ(trim_open_ends({9, 10, 11}, kOptions, &last_known), 1);
  EXPECT_TRUE(last_known.cam_from_world.contains(9));
  EXPECT_EQ(trim_open_ends({10, 11}, kOptions, &last_known), 3) << "two known images join it to nothing";

  SparseModel nothing;
  EXPECT_EQ(trim_open_ends({}, kOptions, &nothing), 0);
}

// Two images share many points that hardly any other image sees: they hold each other, but at any scale.
TEST(TrimOpenEnds, GoTogetherWhereTheySeePointsOfTheirOwn) {
  const TestWindow w = testing::sideways_window(10);
  SparseModel model = testing::true_model(w);
  int shared = 0;
  std::vector<SparseModel::Point> points;
  for (SparseModel::Point& point : model.points) {
    SparseModel::Point own = point, others = point;
    std::erase_if(own.track, [](const auto& o) { return o.first > 1; });
    std::erase_if(others.track, [](const auto& o) { return o.first <= 1; });
    if (!own.track.empty() && !others.track.empty() && shared++ < kOptions.resection_min_inliers) {
      points.push_back(point);
      continue;
    }
    for (const SparseModel::Point& part : {own, others})
      if (part.track.size() >= 2) points.push_back(part);
  }
  model.points = points;
  SparseModel held = model;
  EXPECT_EQ(trim_open_ends({}, kOptions, &model), 2);
  EXPECT_EQ(model.cam_from_world.begin()->first, 2);
  EXPECT_EQ(trim_open_ends({0, 1, 2}, kOptions, &held), 0);
}

TEST(RemoveStrays, RemovesWhatHasAnotherScale) {
  const TestWindow w = testing::sideways_window(10);
  SparseModel model = testing::true_model(w);
  EXPECT_EQ(remove_strays(&model), 0);
  // Three images with points of their own get a scale ten thousand times as large.
  for (SparseModel::Point& point : model.points) std::erase_if(point.track, [](const auto& o) { return o.first > 6; });
  for (const int image : {7, 8, 9}) {
    SE3& pose = model.cam_from_world.at(image);
    pose.translation = -(pose.rotation * (1e4 * pose.center() + Eigen::Vector3d(0, 3e3, 0)));
  }
  EXPECT_EQ(remove_strays(&model), 3);
  EXPECT_EQ(model.cam_from_world.size(), 7U);
  EXPECT_TRUE(model.cam_from_world.contains(0));
}

TEST(RemoveStrays, LeavesALongWayAndAStandAlone) {
  std::vector<SE3> standing(8), way;
  for (int i = 0; i < 20; ++i) way.push_back(SyntheticScene::pose(0.3 * i, 0, 0));
  way.insert(way.begin(), standing.begin(), standing.end());
  std::vector<Eigen::Vector3d> points;
  SyntheticScene scene(9);
  for (int i = 0; i < 20; ++i)
    for (const Eigen::Vector3d& p : scene.cloud(40)) points.push_back(p + Eigen::Vector3d(0.3 * i, 0, 0));
  SparseModel model = testing::true_model(testing::make_window(way, points, 0.5));
  EXPECT_EQ(remove_strays(&model), 0);
  SparseModel nothing;
  EXPECT_EQ(remove_strays(&nothing), 0);
}

TEST(ResectMissingImages, PutsThemBack) {
  TestWindow w = testing::sideways_window(10);
  testing::spoil(&w, 0.1, 0);
  SparseModel model = testing::true_model(w);
  for (const int missing : {2, 3, 9}) model.cam_from_world.erase(missing);
  for (SparseModel::Point& point : model.points)
    std::erase_if(point.track, [&](const auto& o) { return !model.cam_from_world.contains(o.first); });
  std::erase_if(model.points, [](const SparseModel::Point& point) { return point.track.size() < 2; });
  const size_t points = model.points.size();
  EXPECT_EQ(resect_missing_images(w.camera, w.images, w.pairs, kOptions, &model), 3);
  EXPECT_EQ(model.cam_from_world.size(), 10U);
  EXPECT_GE(model.points.size(), points);
  for (const SparseModel::Point& point : model.points) EXPECT_FALSE(testing::sees_an_image_twice(point.track));
  EXPECT_LT(testing::worst_center_error(w, model), 0.03);
  adjust_model(w.camera, w.images, kOptions, &model);
  EXPECT_LT(testing::worst_center_error(w, model), 0.01);
}

TEST(ResectMissingImages, LeavesOutWhatCannotBePlaced) {
  TestWindow w = testing::sideways_window(6);
  std::erase_if(w.pairs, [](const ImagePair& p) { return p.second == 5; });  // the image has no matches
  for (ImagePair& pair : w.pairs)
    if (pair.first == 0) pair.matches.resize(4);  // the image has too few matches
  SparseModel model = testing::true_model(w);
  for (const int missing : {0, 5}) model.cam_from_world.erase(missing);
  for (SparseModel::Point& point : model.points)
    std::erase_if(point.track, [&](const auto& o) { return !model.cam_from_world.contains(o.first); });
  std::erase_if(model.points, [](const SparseModel::Point& point) { return point.track.size() < 2; });
  const SparseModel before = model;
  EXPECT_EQ(resect_missing_images(w.camera, w.images, w.pairs, kOptions, &model), 0);
  EXPECT_TRUE(testing::is_identical(model, before));
}

}  // namespace
}  // namespace rumi::ruminator
