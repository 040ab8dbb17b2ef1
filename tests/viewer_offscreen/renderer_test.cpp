// SPDX-License-Identifier: BSD-3-Clause
#include "viewer_offscreen/renderer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "test_map.h"
#include "viewer_offscreen/draw_map.h"
#include "viewer_offscreen/projection.h"

namespace rumi {
namespace {

const cv::Rect kOblique(20, 62, 836, 638);

int count(const cv::Mat& picture, const cv::Vec3b& rgb, const cv::Rect& where = kOblique) {
  cv::Mat mask;
  const cv::Scalar bgr(rgb[2], rgb[1], rgb[0]);
  cv::inRange(picture(where), bgr - cv::Scalar::all(6), bgr + cv::Scalar::all(6), mask);
  return cv::countNonZero(mask);
}

bool equal(const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_INF) == 0; }

class MapPictureTest : public testing::Test {
 protected:
  Submap first_ = make_test_submap(1, 0, 8, test_circle, 500);
  Submap second_ = make_test_submap(2, 9, 16, test_circle, 500);
};

TEST_F(MapPictureTest, EachSubmapHasItsColour) {
  MapPicture one{.title = "one", .submaps = {{&first_, true}}};
  MapPicture two{.title = "two", .submaps = {{&first_, true}, {&second_, true}}};
  const cv::Mat a = draw_map(one), b = draw_map(two);
  EXPECT_EQ(a.size(), cv::Size(1280, 720));
  EXPECT_EQ(a.type(), CV_8UC3);
  EXPECT_GT(count(a, submap_color(0)), 300);
  EXPECT_EQ(count(a, submap_color(1)), 0);
  EXPECT_GT(count(b, submap_color(0)), 200);
  EXPECT_GT(count(b, submap_color(1)), 200);
  EXPECT_TRUE(equal(b, draw_map(two)));
}

TEST_F(MapPictureTest, TrajectoryIsWhereTheProjectionPutsIt) {
  const MapPicture picture{.submaps = {{&first_, true}}};
  const Scene scene = make_scene(picture);
  const std::vector<const SubmapView*> shown{&scene.submaps[0]};
  const cv::Rect top(874, 62, 386, 318);
  const Projection project(principal_plane(shown), 0, M_PI / 2, top, shown);
  const cv::Mat drawn = Renderer().draw(scene);
  int near = 0;
  for (const TrajectoryPoint& p : scene.submaps[0].trajectory) {
    const cv::Point2d at = project(p.position);
    near += count(drawn, submap_color(0), cv::Rect(static_cast<int>(at.x) - 2, static_cast<int>(at.y) - 2, 5, 5)) > 0;
  }
  EXPECT_GT(near, 0.85 * static_cast<double>(scene.submaps[0].trajectory.size()));  // the frustum hides the end
}

TEST_F(MapPictureTest, LostSpansAreFoundAndDrawn) {
  MapPicture picture{.submaps = {{&first_, true}, {&second_, true}}, .frame_utimes_us = test_utimes(0, 16)};
  const Scene scene = make_scene(picture);
  ASSERT_EQ(scene.lost.size(), 1u);
  EXPECT_EQ(scene.lost[0].frames, 30);
  EXPECT_EQ(scene.frames, 480);
  EXPECT_EQ(scene.frames_in_map, 450);
  EXPECT_GT(count(draw_map(picture), kLostColor), 20);
  EXPECT_EQ(count(draw_map({.submaps = {{&first_, true}}, .frame_utimes_us = test_utimes(0, 8)}), kLostColor), 0);
}

TEST_F(MapPictureTest, ALossWithinASubmapBreaksItsLine) {
  for (auto it = first_.frames.begin(); it != first_.frames.end();)
    it = it->first > 4'000'000 && it->first < 5'000'000 ? first_.frames.erase(it) : std::next(it);
  const Scene scene = make_scene({.submaps = {{&first_, true}}, .frame_utimes_us = test_utimes(0, 8)});
  ASSERT_EQ(scene.lost.size(), 1u);
  int breaks = 0;
  for (const TrajectoryPoint& p : scene.submaps[0].trajectory) breaks += p.after_loss;
  EXPECT_EQ(breaks, 1);
}

TEST_F(MapPictureTest, SubmapsApartAreShown) {
  const cv::Mat drawn = draw_map({.submaps = {{&first_, true}, {&second_, false}}});
  EXPECT_GT(count(drawn, submap_color(1)), 30);
  const Scene stand_in = make_scene({.submaps = {{&second_, false}, {&first_, false}}});
  EXPECT_FALSE(stand_in.submaps[0].placed);
  EXPECT_TRUE(stand_in.submaps[1].placed);  // it has more frames
}

TEST_F(MapPictureTest, NothingToShowIsAPictureToo) {
  const cv::Mat drawn = draw_map({});
  EXPECT_EQ(drawn.size(), cv::Size(1280, 720));
  EXPECT_EQ(count(drawn, submap_color(0)), 0);
  Submap empty;
  EXPECT_EQ(draw_map({.submaps = {{&empty, true}}, .frame_utimes_us = test_utimes(0, 1)}).cols, 1280);
  const Submap single = make_test_submap(1, 0, 1.0 / 30, test_circle, 0);
  EXPECT_EQ(draw_map({.submaps = {{&single, true}}}).cols, 1280);
}

TEST_F(MapPictureTest, NumbersThatAreNotFiniteAreLeftOut) {
  const cv::Mat clean = draw_map({.submaps = {{&first_, true}}});
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const Scene before = make_scene({.submaps = {{&first_, true}}});
  int id = 100'000;
  for (const double bad : {nan, inf, -inf, 1e300}) first_.landmarks[++id].position = {0, bad, 0};
  first_.keyframes[2].cam_from_submap.translation.x() = nan;
  const Scene after = make_scene({.submaps = {{&first_, true}}});
  EXPECT_EQ(after.submaps[0].landmarks.size(), before.submaps[0].landmarks.size());
  EXPECT_EQ(after.submaps[0].keyframe_poses.size(), before.submaps[0].keyframe_poses.size() - 1);
  EXPECT_EQ(after.submaps[0].trajectory.size(), before.submaps[0].trajectory.size() - 10);
  EXPECT_GT(count(draw_map({.submaps = {{&first_, true}}}), submap_color(0)), 0.8 * count(clean, submap_color(0)));
}

TEST_F(MapPictureTest, HugeMapsAndOutliersDoNotShrinkTheTrajectory) {
  const int before = count(draw_map({.submaps = {{&first_, true}}}), submap_color(0));
  Submap huge = make_test_submap(1, 0, 8, test_circle, 100'000);
  cv::RNG rng(3);
  for (int i = 0; i < 4000; ++i)
    huge.landmarks[200'000 + i].position = Eigen::Vector3d(rng.uniform(-1e6, 1e6), rng.uniform(-1e6, 1e6), 1e5);
  EXPECT_GT(count(draw_map({.submaps = {{&huge, true}}}), submap_color(0)), 0.5 * before);
}

TEST_F(MapPictureTest, TruthIsAlignedToTheMap) {
  MapPicture picture{.submaps = {{&first_, true}}};
  for (const int64_t t : test_utimes(0, 8))
    picture.groundtruth[t] = 7 * test_circle(static_cast<double>(t - 1'000'000) * 1e-6) + Eigen::Vector3d(5, -3, 2);
  const Scene scene = make_scene(picture);
  ASSERT_EQ(scene.truth.size(), 240u);
  EXPECT_LT((scene.truth[100] - scene.submaps[0].trajectory[100].position).norm(), 1e-3);
  picture.groundtruth = {{1, Eigen::Vector3d::Zero()}};
  EXPECT_TRUE(make_scene(picture).truth.empty());
}

TEST(WritePng, SaysWhichFileCannotBeWritten) {
  const cv::Mat picture(10, 10, CV_8UC3, cv::Scalar::all(9));
  EXPECT_THAT(write_png(picture, "/nowhere/a.png"), testing::HasSubstr("/nowhere/a.png"));
}

TEST(PrincipalPlane, IsTheCirclesAndFacesUp) {
  const Submap submap = make_test_submap(1, 0, 20, test_circle, 100);
  const Scene scene = make_scene({.submaps = {{&submap, true}}});
  const PrincipalPlane plane = principal_plane({&scene.submaps[0]});
  EXPECT_GT(plane.axes(2, 2), 0.99);
  EXPECT_NEAR(plane.axes.determinant(), 1, 1e-9);
}

TEST(RoundLength, IsOneTwoOrFive) {
  EXPECT_DOUBLE_EQ(round_length(0.034), 0.02);
  EXPECT_DOUBLE_EQ(round_length(6), 5);
  EXPECT_DOUBLE_EQ(round_length(9), 10);
  EXPECT_DOUBLE_EQ(round_length(std::numeric_limits<double>::quiet_NaN()), 1);
}

}  // namespace
}  // namespace rumi
