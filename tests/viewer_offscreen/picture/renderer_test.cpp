// SPDX-License-Identifier: BSD-3-Clause
#include "viewer_offscreen/picture/renderer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <utility>

#include "tests/viewer_offscreen/test_map.h"
#include "viewer_offscreen/picture/draw_map.h"
#include "viewer_offscreen/picture/timeline_strip.h"
#include "viewer_offscreen/scene/covisibility.h"
#include "viewer_offscreen/scene/projection.h"

namespace rumi::viewer_offscreen {
namespace {

const cv::Rect kOblique(16, 52, 640, 566);
const cv::Vec3b kFirst = submap_color(SubmapKind::kFront, 0), kSecond = submap_color(SubmapKind::kFront, 1);

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
  EXPECT_GT(count(a, kFirst), 300);
  EXPECT_EQ(count(a, kSecond), 0);
  EXPECT_GT(count(b, kFirst), 200);
  EXPECT_GT(count(b, kSecond), 200);
  EXPECT_TRUE(equal(b, draw_map(two)));
}

TEST_F(MapPictureTest, TrajectoryIsWhereTheProjectionPutsIt) {
  const MapPicture picture{.submaps = {{&first_, true}}};
  const Scene scene = make_scene(picture);
  const std::vector<const SubmapView*> shown{&scene.submaps[0]};
  const Projection project =
      Projection::parallel(principal_plane(shown), 0, M_PI / 2, layout_all(false).views[1].panel, shown);
  const cv::Mat drawn = Renderer().draw(scene);
  int near = 0;
  for (const TrajectoryPoint& p : scene.submaps[0].trajectory) {
    const cv::Point2d at = project(p.position);
    near += count(drawn, kFirst, cv::Rect(static_cast<int>(at.x) - 2, static_cast<int>(at.y) - 2, 5, 5)) > 0;
  }
  EXPECT_GT(near, 0.85 * static_cast<double>(scene.submaps[0].trajectory.size()));  // the frustum hides the end of the
                                                                                    // path
}

TEST_F(MapPictureTest, LostSpansAreFoundAndDrawn) {
  MapPicture picture{.submaps = {{&first_, true}, {&second_, true}}, .frames = test_frames(0, 16)};
  const Scene scene = make_scene(picture);
  ASSERT_EQ(scene.lost.size(), 1u);
  EXPECT_EQ(scene.lost[0].frames, 30);
  EXPECT_EQ(scene.frames, 480);
  EXPECT_EQ(scene.frames_in_map, 450);
  EXPECT_GT(count(draw_map(picture), kLostColor), 20);
  EXPECT_EQ(count(draw_map({.submaps = {{&first_, true}}, .frames = test_frames(0, 8)}), kLostColor), 0);
}

TEST_F(MapPictureTest, ALossWithinASubmapBreaksItsLine) {
  const FrameTable all = std::exchange(first_.frames, {});
  for (const auto& [utime_us, frame] : all)
    if (utime_us <= 4'000'000 || utime_us >= 5'000'000) first_.frames.set(frame);
  const Scene scene = make_scene({.submaps = {{&first_, true}}, .frames = test_frames(0, 8)});
  ASSERT_EQ(scene.lost.size(), 1u);
  int breaks = 0;
  for (const TrajectoryPoint& p : scene.submaps[0].trajectory) breaks += p.after_loss;
  EXPECT_EQ(breaks, 1);
}

TEST_F(MapPictureTest, SubmapsApartAreShown) {
  const cv::Mat drawn = draw_map({.submaps = {{&first_, true}, {&second_, false}}});
  EXPECT_GT(count(drawn, kSecond), 30);
  const Scene stand_in = make_scene({.submaps = {{&second_, false}, {&first_, false}}});
  EXPECT_FALSE(stand_in.submaps[0].placed);
  EXPECT_TRUE(stand_in.submaps[1].placed);  // it has more frames
}

TEST_F(MapPictureTest, NothingToShowIsAPictureToo) {
  const cv::Mat drawn = draw_map({});
  EXPECT_EQ(drawn.size(), cv::Size(1280, 720));
  EXPECT_EQ(count(drawn, kFirst), 0);
  Submap empty;
  EXPECT_EQ(draw_map({.submaps = {{&empty, true}}, .frames = test_frames(0, 1)}).cols, 1280);
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
  EXPECT_GT(count(draw_map({.submaps = {{&first_, true}}}), kFirst), 0.8 * count(clean, kFirst));
}

TEST_F(MapPictureTest, HugeMapsAndOutliersDoNotShrinkTheTrajectory) {
  const int before = count(draw_map({.submaps = {{&first_, true}}}), kFirst);
  Submap huge = make_test_submap(1, 0, 8, test_circle, 100'000);
  cv::RNG rng(3);
  for (int i = 0; i < 4000; ++i)
    huge.landmarks[200'000 + i].position = Eigen::Vector3d(rng.uniform(-1e6, 1e6), rng.uniform(-1e6, 1e6), 1e5);
  EXPECT_GT(count(draw_map({.submaps = {{&huge, true}}}), kFirst), 0.5 * before);
}

TEST_F(MapPictureTest, TruthIsAlignedToTheMap) {
  MapPicture picture{.submaps = {{&first_, true}}};
  for (const FrameNote& frame : test_frames(0, 8))
    picture.groundtruth[frame.utime_us] =
        7 * test_circle(static_cast<double>(frame.utime_us - 1'000'000) * 1e-6) + Eigen::Vector3d(5, -3, 2);
  const Scene scene = make_scene(picture);
  ASSERT_EQ(scene.truth.size(), 240u);
  EXPECT_LT((scene.truth[100] - scene.submaps[0].trajectory[100].position).norm(), 1e-3);
  EXPECT_NEAR(scene.metres_per_unit.value(), 7, 1e-2);
  picture.groundtruth = {{1, Eigen::Vector3d::Zero()}};
  EXPECT_TRUE(make_scene(picture).truth.empty());
}

TEST_F(MapPictureTest, ABackSubmapHasAnotherStyleAndLiesUnderTheFront) {
  const Submap back = make_test_submap(-1, 7, 10, test_circle, 100);
  const MapPicture picture{.submaps = {{&back, true}, {&first_, true}, {&second_, true}}, .frames = test_frames(0, 16)};
  const Scene scene = make_scene(picture);
  const cv::Mat drawn = draw_map(picture);
  EXPECT_GT(count(drawn, submap_color(SubmapKind::kBack, 0)), 20);
  EXPECT_TRUE(scene.lost.empty());
  // The frames of the middle second of the back submap are in no front submap.
  EXPECT_EQ(scene.timeline.filled, 30);
  EXPECT_EQ(scene.frames_in_map, 480);
  ASSERT_EQ(scene.timeline.in_map.size(), 3u);
  EXPECT_EQ(scene.timeline.in_map[1].submap, 0);
  const cv::Rect lane = layout_all(false).strip;
  EXPECT_GT(count(drawn, submap_color(SubmapKind::kBack, 0), lane), 200);
  EXPECT_GT(count(drawn, kFirst, lane), 2000);
}

TEST_F(MapPictureTest, ASubmapKeepsItsColourWhenOthersCome) {
  const Submap back_1 = make_test_submap(-1, 0, 1, test_circle, 10),
               back_2 = make_test_submap(-2, 1, 2, test_circle, 10);
  const Scene few = make_scene({.submaps = {{&back_1, true}, {&first_, true}}});
  const Scene more = make_scene({.submaps = {{&back_2, true}, {&back_1, true}, {&first_, true}, {&second_, true}}});
  EXPECT_EQ(few.submaps[0].color, more.submaps[1].color);
  EXPECT_EQ(few.submaps[1].color, more.submaps[2].color);
  EXPECT_NE(more.submaps[0].color, more.submaps[1].color);
}

TEST_F(MapPictureTest, TheStripTellsLostFromRecentlyLost) {
  MapPicture picture{.submaps = {{&first_, true}}, .frames = test_frames(0, 12)};
  for (FrameNote& frame : picture.frames) {
    const bool tracked = frame.utime_us < 9'000'000;
    frame.state = tracked ? 1 : frame.utime_us < 11'000'000 ? 2 : 3;
    if (tracked) frame.submap = first_.key;
  }
  const cv::Mat drawn = draw_map(picture);
  const cv::Rect strip = layout_all(false).strip;
  const Scene scene = make_scene(picture);
  ASSERT_EQ(scene.timeline.tracked.size(), 3u);
  const cv::Rect right(strip.x + strip.width * 3 / 4, strip.y + 20, strip.width / 4, 14);
  EXPECT_GT(count(drawn, kRecentlyLostColor, right), 300);
  EXPECT_GT(count(drawn, kLostColor, right), 300);
  EXPECT_EQ(count(drawn, kFirst, right), 0);
}

TEST_F(MapPictureTest, AFrameThatIsTrackedButWhosePoseHasNotComeIsNotLost) {
  MapPicture picture{.submaps = {{&first_, true}}, .frames = test_frames(0, 10)};
  for (FrameNote& frame : picture.frames)
    if (frame.utime_us < 10'000'000) {
      frame.state = 1;
      frame.submap = first_.key;
    }
  const Scene scene = make_scene(picture);  // the submap ends at 9 s
  EXPECT_EQ(scene.frames_in_map, 271);
  ASSERT_EQ(scene.lost.size(), 1u);
  EXPECT_GE(scene.lost[0].first_us, 10'000'000);
}

TEST_F(MapPictureTest, JoinedSubmapsAreLinkedWhereBothHaveTheImage) {
  const Submap back = make_test_submap(-1, 6, 10, test_circle, 100);
  MapPicture picture{.submaps = {{&back, true}, {&first_, true}, {&second_, true}}};
  picture.links = {{first_.key, back.key, true, true},
                   {first_.key, second_.key, false, true},
                   {second_.key, back.key, true, false},
                   {first_.key, {9, 9}, true, true}};
  const Scene scene = make_scene(picture);
  ASSERT_EQ(scene.merges.size(), 2u);
  EXPECT_LT((scene.merges[0].at_a - scene.merges[0].at_b).norm(), 1e-9);
  // The keyframes nearest to each other are the last of the one and the first of the other.
  EXPECT_LT((scene.merges[1].at_a - first_.keyframes.rbegin()->second.cam_from_submap.center()).norm(), 1e-9);
  EXPECT_LT((scene.merges[1].at_b - second_.keyframes.begin()->second.cam_from_submap.center()).norm(), 1e-9);
  EXPECT_EQ(scene.refused_links, 1);
  const MapPicture without{.submaps = picture.submaps};
  EXPECT_GT(count(draw_map(picture), kMergeColor), count(draw_map(without), kMergeColor) + 20);
}

TEST_F(MapPictureTest, CovisiblePairsShareLandmarks) {
  for (auto& [id, keyframe] : first_.keyframes) {
    auto features = std::make_shared<Features>();
    features->keypoints.resize(300);
    keyframe.features = features;
    keyframe.landmark_ids.assign(300, kNone);
  }
  cv::RNG rng(4);
  std::map<int, int> used;
  for (auto& [landmark_id, landmark] : first_.landmarks) {
    const int from = rng.uniform(0, 24);
    for (int k = from; k < std::min(24, from + rng.uniform(1, 8)); ++k)
      if (used[k] < 300) first_.add_observation(landmark_id, k, used[k]++);
  }
  std::vector<std::pair<int, int>> expected;
  for (const auto& [id, keyframe] : first_.keyframes)
    for (const auto& [other, shared] : first_.covisible_keyframes(id))
      if (other > id && shared >= 40) expected.emplace_back(id, other);
  EXPECT_GT(expected.size(), 5u);
  EXPECT_THAT(covisible_pairs(first_, 40), testing::UnorderedElementsAreArray(expected));
  EXPECT_EQ(make_scene({.submaps = {{&first_, true}}}).submaps[0].covisible.size(), expected.size());
  first_.keyframes.erase(3);  // landmarks still have observations of it
  EXPECT_LT(covisible_pairs(first_, 40).size(), expected.size());
}

TEST_F(MapPictureTest, TheImageIsShownWithItsKeypoints) {
  MapPicture picture{.submaps = {{&first_, true}}};
  const cv::Mat without = draw_map(picture);
  picture.camera_view.image = cv::Mat(48, 64, CV_8UC3, cv::Scalar(40, 160, 240));
  const cv::Rect room = layout_all(true).camera;
  const cv::Mat bare = draw_map(picture);
  EXPECT_GT(count(bare, {240, 160, 40}, room), 0.95 * room.height * room.height * 4 / 3);
  EXPECT_EQ(count(without, {240, 160, 40}, room), 0);
  picture.camera_view.size = {640, 480};
  picture.camera_view.on_landmarks = {{320, 240}, {-1e9f, 7}, {std::numeric_limits<float>::quiet_NaN(), 7}};
  const cv::Mat marked = draw_map(picture);
  const cv::Rect middle(room.x + room.width / 2 - 4, room.y + room.height / 2 - 4, 9, 9);
  EXPECT_GT(count(marked, kSecond, middle), 0);
  cv::Mat difference;
  cv::absdiff(bare(room), marked(room), difference);
  cv::Mat changed;
  cv::inRange(difference, cv::Scalar::all(0), cv::Scalar::all(3), changed);
  EXPECT_LT(room.area() - cv::countNonZero(changed), 60);
}

TEST_F(MapPictureTest, OneViewFillsThePicture) {
  const MapPicture picture{.submaps = {{&first_, true}}};
  const cv::Rect large = layout_one(ViewKind::kTop, false).views[0].panel;
  for (const ViewKind kind : {ViewKind::kOblique, ViewKind::kTop, ViewKind::kSide, ViewKind::kFollow}) {
    const cv::Mat drawn = draw_map(picture, kind);
    EXPECT_EQ(drawn.size(), cv::Size(1280, 720));
    EXPECT_GT(count(drawn, kFirst, large), 100);
  }
}

TEST(FollowView, LooksPastTheCameraAndCutsOffWhatIsBehind) {
  const Submap submap = make_test_submap(1, 0, 20, test_circle, 100);
  const Scene scene = make_scene({.submaps = {{&submap, true}}});
  const PrincipalPlane plane = principal_plane({&scene.submaps[0]});
  const cv::Rect panel(100, 50, 300, 200);
  const SE3 camera = *scene.camera;
  const Projection project = Projection::follow(plane, camera, panel);
  const Eigen::Vector3d ahead = camera * Eigen::Vector3d(0, 0, plane.extent);
  EXPECT_TRUE(panel.contains(project(camera.translation)));
  EXPECT_TRUE(panel.contains(project(ahead)));
  EXPECT_LT(project(ahead).y, project(camera.translation).y);  // farther away is higher up
  EXPECT_LT(project(camera * Eigen::Vector3d(-0.1, 0, 0)).x, project(camera * Eigen::Vector3d(0.1, 0, 0)).x);
  Eigen::Vector3d behind = camera * Eigen::Vector3d(0, 0, -5 * plane.extent), a = camera.translation;
  EXPECT_TRUE(project.clip(&a, &behind));
  EXPECT_EQ(a, camera.translation);
  EXPECT_LT((behind - a).norm(), plane.extent);
  Eigen::Vector3d c = camera * Eigen::Vector3d(1, 0, -5 * plane.extent), d = camera * Eigen::Vector3d(0, 0, -9);
  EXPECT_FALSE(project.clip(&c, &d));
}

TEST(Times, AreRound) {
  EXPECT_EQ(format_time(12.34), "12.3 s");
  EXPECT_EQ(format_time(245), "4:05");
  EXPECT_EQ(format_time(3723), "1:02:03");
  EXPECT_DOUBLE_EQ(round_time_step(75, 12), 10);
  EXPECT_DOUBLE_EQ(round_time_step(0.5, 12), 0.1);
  for (const double duration : {0.001, 3.0, 500.0, 1e5, 1e9}) EXPECT_LE(duration / round_time_step(duration, 12), 12);
}

TEST(WritePng, SaysWhichFileCannotBeWritten) {
  const cv::Mat picture(10, 10, CV_8UC3, cv::Scalar::all(9));
  EXPECT_THAT(write_png(picture, "/nowhere/a.png").error_text(), testing::HasSubstr("/nowhere/a.png"));
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
}  // namespace rumi::viewer_offscreen
