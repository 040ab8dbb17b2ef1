// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/model/scale_check.h"

#include <gtest/gtest.h>

#include "tests/ruminator/test_window.h"

namespace rumi::ruminator {
namespace {

using testing::TestWindow;

// Scales everything after the image by `factor`, about that image's camera.
void slip(int image, double factor, SparseModel* model) {
  repair_scale({.image = image, .log_ratio = -std::log(factor)}, model);
}

TEST(ScaleCheck, FindsNothingInARightModel) {
  const TestWindow w = testing::sideways_window(12);
  const auto cuts = check_scale(w.camera, w.images, join_tracks(w.images, w.pairs), testing::true_model(w));
  ASSERT_EQ(cuts.size(), 11U);
  EXPECT_FALSE(find_slip(cuts));
  EXPECT_FALSE(find_break(cuts));
  EXPECT_GT(cuts[5].points, 50);
  EXPECT_NEAR(cuts[5].log_ratio, 0, 0.05);
}

TEST(ScaleCheck, FindsASlipAndRepairsIt) {
  const TestWindow w = testing::sideways_window(12);
  const std::vector<Track> tracks = join_tracks(w.images, w.pairs);
  for (const double factor : {3.0, 0.4}) {
    SparseModel model = testing::true_model(w);
    slip(5, factor, &model);
    const auto found = find_slip(check_scale(w.camera, w.images, tracks, model));
    ASSERT_TRUE(found);
    EXPECT_EQ(found->image, 5);
    EXPECT_NEAR(found->log_ratio, std::log(factor), 0.1);
    repair_scale(*found, &model);
    EXPECT_FALSE(find_slip(check_scale(w.camera, w.images, tracks, model)));
    EXPECT_LT(testing::worst_center_error(w, model), 0.1);
  }
}

TEST(ScaleCheck, ABreakIsWhereNoPointTells) {
  TestWindow w = testing::sideways_window(12);
  std::erase_if(w.pairs, [](const ImagePair& p) { return p.first <= 7 && p.second > 7; });
  SparseModel model = testing::true_model(w);
  model.points.clear();
  const std::vector<Track> tracks = join_tracks(w.images, w.pairs);
  triangulate_tracks(w.camera, w.images, tracks, {}, &model);
  const auto found = find_break(check_scale(w.camera, w.images, tracks, model));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->image, 7);
  EXPECT_EQ(found->points, 0);
  keep_larger_side(*found, &model);
  EXPECT_EQ(model.cam_from_world.size(), 8U);
  for (const SparseModel::Point& point : model.points)
    for (const auto& [image, keypoint] : point.track) EXPECT_LE(image, 7);
  EXPECT_FALSE(find_break(check_scale(w.camera, w.images, tracks, model)));
}

// Returns the cuts of a model in which only `keep` tracks cross the cut after image 7. After the cut, the points of
// these tracks are farther or nearer by a factor of `scatter`, alternately.
std::vector<ScaleCut> cuts_with_few_points(int keep, double scatter) {
  TestWindow w = testing::sideways_window(12, 0.3);
  const SparseModel model = testing::true_model(w);
  std::vector<Track> tracks;
  for (const Track& track : join_tracks(w.images, w.pairs)) {
    Track before, after;
    for (const auto& o : track) (o.first <= 7 ? before : after).push_back(o);
    if (before.size() >= 4 && after.size() >= 4 && keep > 0) {
      const double factor = keep-- % 2 == 0 ? scatter : 1 / scatter;
      const auto point = triangulate_track(w.camera, w.images, after, {}, model);
      const Eigen::Vector3d center = model.cam_from_world.at(7).center();
      for (const auto& [image, keypoint] : after)
        w.images[image].keypoints[keypoint] =
            w.camera
                .project_undistorted(model.cam_from_world.at(image) *
                                     (center + factor * (point->position - center)).eval())
                .cast<float>();
      tracks.push_back(track);
      continue;
    }
    for (const Track& part : {before, after})
      if (part.size() >= 2) tracks.push_back(part);
  }
  return check_scale(w.camera, w.images, tracks, model);
}

TEST(ScaleCheck, AFewPointsWillDoWhereTheyAgree) {
  const auto agreeing = cuts_with_few_points(3, 1.0);
  EXPECT_EQ(agreeing[7].points, 3);
  EXPECT_FALSE(agreeing[7].is_break);
  EXPECT_TRUE(cuts_with_few_points(3, 1.3)[7].is_break);
  EXPECT_TRUE(cuts_with_few_points(2, 1.0)[7].is_break);
}

TEST(ScaleCheck, ACameraThatStandsStillHasNoScaleToLose) {
  TestWindow w = testing::sideways_window(12);
  SparseModel model = testing::true_model(w);
  for (int image = 0; image < 6; ++image) model.cam_from_world[image] = model.cam_from_world[0];
  for (SparseModel::Point& point : model.points) std::erase_if(point.track, [](const auto& o) { return o.first < 6; });
  std::erase_if(model.points, [](const SparseModel::Point& point) { return point.track.size() < 2; });
  std::vector<Track> tracks = join_tracks(w.images, w.pairs);
  for (Track& track : tracks) std::erase_if(track, [](const auto& o) { return o.first < 6; });
  std::erase_if(tracks, [](const Track& track) { return track.size() < 2; });
  EXPECT_FALSE(find_break(check_scale(w.camera, w.images, tracks, model)));
}

TEST(ScaleCheck, OfNothingIsNothing) {
  const TestWindow w = testing::sideways_window(3);
  EXPECT_TRUE(check_scale(w.camera, w.images, {}, {}).empty());
}

}  // namespace
}  // namespace rumi::ruminator
