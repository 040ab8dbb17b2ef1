// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/patches/patch_tracking.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "front_tracker/tracking/tracker.h"
#include "tests/front_tracker/walk_submap.h"

namespace rumi::front_tracker {
namespace {

using testing::expect_consistent;
using testing::frame_of;
using testing::median_shift;
using testing::submap_of;
using testing::walk;

constexpr size_t kLast = 32;

// Returns the frame before the one that is tracked; it is keyframe 1 of the submap.
Frame last_frame(const FrontSubmap& s) {
  Frame last = frame_of(kLast);
  last.landmark_ids = s.map.keyframe(1)->landmark_ids;
  return last;
}

// Returns an image without features, at a pose at which predictions are some pixels off.
Frame next_frame(const cv::Mat& image) {
  Frame frame;
  frame.utime_us = walk().utime_us[kLast + 1];
  frame.images = std::make_shared<const ImagePyramid>(OrbExtractor({}).pyramid(image));
  frame.corners = Corners::kNone;
  frame.cam_from_submap =
      SE3::exp((Vector6d() << 0, 0, 0, 0.006, -0.006, 0).finished()) * walk().cam_from_room[kLast + 1];
  return frame;
}

TEST(PatchTracking, FindsThePoseAndTheLandmarksOfTheLastFrame) {
  const auto s = submap_of({20, kLast});
  const Frame last = last_frame(*s);
  const SE3& truth = walk().cam_from_room[kLast + 1];
  Frame frame = next_frame(walk().images[kLast + 1]);
  frame.landmark_ids = last.landmark_ids;
  ASSERT_GT(median_shift(*s, frame, truth), 2) << "px";
  PatchTemplates templates;
  ASSERT_TRUE(find_pose_by_patches(*s, last, &frame, &templates));
  EXPECT_LT(frame.features->size(), 110u) << "a few do";
  EXPECT_LT(median_shift(*s, frame, truth), 1) << "px";
  const PatchTracking tracked = track_by_patches(*s, last, &frame, &templates);
  EXPECT_GT(tracked.in_view, 0.8 * last.matches());
  EXPECT_LE(tracked.in_view, last.matches());
  EXPECT_GT(tracked.inliers, 0.7 * tracked.in_view);
  EXPECT_EQ(tracked.inliers, frame.matches());
  EXPECT_LT(median_shift(*s, frame, truth), 0.5) << "px";
  expect_consistent(frame);
}

// Part of the image is replaced by another picture: landmarks there must not be found, and the pose must stay right.
TEST(PatchTracking, WhatIsHiddenIsNotFound) {
  const auto s = submap_of({20, kLast});
  const Frame last = last_frame(*s);
  cv::Mat image = walk().images[kLast + 1].clone();
  const cv::Rect hidden(0, 0, image.cols * 2 / 3, image.rows);
  walk().images[100](hidden).copyTo(image(hidden));
  Frame frame = next_frame(image);
  PatchTemplates templates;
  ASSERT_TRUE(find_pose_by_patches(*s, last, &frame, &templates));
  const PatchTracking tracked = track_by_patches(*s, last, &frame, &templates);
  EXPECT_GT(tracked.in_view, 0.8 * last.matches());
  EXPECT_LT(tracked.inliers, 0.8 * tracked.in_view);
  int in_the_other = 0;
  for (size_t i = 0; i < frame.features->size(); ++i) {
    const Keypoint& k = frame.features->keypoints[i];
    const double patch_px = 4 * s->octave_scales[k.octave];  // radius of the smaller patch: nearer to the edge it shows
                                                             // some of the true image
    in_the_other += frame.landmark_ids[i] != kNone && k.pixel.x() < hidden.width - patch_px;
  }
  EXPECT_LE(in_the_other, 0.02 * tracked.inliers) << "by chance, of " << tracked.inliers;
  EXPECT_LT(median_shift(*s, frame, walk().cam_from_room[kLast + 1]), 1) << "px";
}

TEST(PatchTracking, NoPoseFromAnotherImageOrFromNothing) {
  const auto s = submap_of({20, kLast});
  const Frame last = last_frame(*s);
  PatchTemplates templates;
  Frame black = next_frame(cv::Mat::zeros(walk().images[0].size(), CV_8U));
  EXPECT_FALSE(find_pose_by_patches(*s, last, &black, &templates));
  Frame elsewhere = next_frame(walk().images[100]);
  EXPECT_FALSE(find_pose_by_patches(*s, last, &elsewhere, &templates));
  Frame behind = next_frame(walk().images[kLast + 1]);
  behind.cam_from_submap = SE3::exp((Vector6d() << 0, 0, 0, 0, M_PI, 0).finished()) * behind.cam_from_submap;
  EXPECT_FALSE(find_pose_by_patches(*s, last, &behind, &templates));
  Frame unmatched = last_frame(*s);
  unmatched.clear_matches();
  Frame frame = next_frame(walk().images[kLast + 1]);
  EXPECT_FALSE(find_pose_by_patches(*s, unmatched, &frame, &templates));
  s->keep_images(0);
  EXPECT_FALSE(find_pose_by_patches(*s, last, &frame, &templates)) << "no images, no patches";
}

constexpr int kNearlyAll = 28;

// Returns how many of the last thirty images are tracked. Thirty come per second; after two seconds they are blurred.
int tracked_in_blur(double blur_px, const FrontTrackerOptions& options, testing::Error* error) {
  static const testing::RenderedWalk sharp = testing::render_walk(3, 30);
  constexpr size_t kFirst = 60;
  int tracked = 0;
  bool soon_keyframe = false;
  Tracker tracker(sharp.camera, options, 1);
  for (size_t i = 0; i < sharp.images.size(); ++i) {
    cv::Mat image = sharp.images[i].clone();
    if (i >= kFirst) cv::GaussianBlur(sharp.images[i], image, {}, blur_px);
    const auto r = tracker.process(sharp.utime_us[i], image);
    soon_keyframe |= i >= kFirst && i < kFirst + 3 && r->is_keyframe;
    tracked += i >= kFirst && r->state == TrackingState::kTracking;
  }
  EXPECT_TRUE(soon_keyframe) << "its corners are what the next are tracked by";
  EXPECT_EQ(tracker.submaps().size(), 1u);
  *error = testing::error_of(tracker.submaps()[0]->map, sharp.center);
  return tracked;
}

// Few corners are left in the blurred images, but patches hardly change.
TEST(PatchTracking, ImagesThatBlurAreTracked) {
  FrontTrackerOptions options = testing::replay_options();
  options.tracking.corner_interval_s = 0.09;
  options.keyframes.max_motion = 1;
  testing::Error error;
  EXPECT_GE(tracked_in_blur(2.5, options, &error), kNearlyAll);
  EXPECT_LT(error.rmse_m, 0.02 * error.path_m);
}

// The default options look for corners at another interval.
TEST(PatchTracking, ImagesThatBlurAreTrackedAsTheOptionsAre) {
  for (const double blur_px : {2.0, 2.5}) {
    testing::Error error;
    EXPECT_GE(tracked_in_blur(blur_px, testing::replay_options(), &error), kNearlyAll) << blur_px << " px";
    EXPECT_LT(error.rmse_m, 0.02 * error.path_m) << blur_px << " px";
  }
}

// Corners are detected in one of thirteen images, of which ninety come per second.
TEST(PatchTracking, CornersAreSoughtAsOftenAsAskedFor) {
  const testing::RenderedWalk fast = testing::render_walk(1.5, 90);
  for (const bool follows : {false, true}) {
    FrontTrackerOptions options = testing::replay_options();
    if (!follows) options.tracking.corner_interval_s = 0;
    options.keyframes.max_motion = 1;  // the interval alone decides
    Tracker tracker(fast.camera, options, 1);
    int tracked = 0, without_corners = 0;
    for (size_t i = 0; i < fast.images.size(); ++i) {
      const auto r = tracker.process(fast.utime_us[i], fast.images[i]);
      if (tracked == 0 && r->state != TrackingState::kTracking) continue;
      ASSERT_EQ(r->state, TrackingState::kTracking) << "image " << i;
      ++tracked;
      if (r->keypoints > 1.2 * r->inliers) continue;  // corners were detected: not all keypoints are landmarks
      ++without_corners;
      EXPECT_FALSE(r->is_keyframe);
      EXPECT_GE(r->inliers, 50);
    }
    if (follows) {
      EXPECT_GT(without_corners, 0.8 * tracked);
    } else {
      EXPECT_EQ(without_corners, 0);
    }
    ASSERT_EQ(tracker.submaps().size(), 1u);
    const testing::Error error = testing::error_of(tracker.submaps()[0]->map, fast.center);
    EXPECT_LT(error.rmse_m, 0.02 * error.path_m) << "with corners in " << (follows ? "some images" : "every image");
  }
}

// An image without corners cannot become a keyframe. Once the images without corners have moved so far that a keyframe
// is due, corners must be detected again.
TEST(PatchTracking, CornersAreSoughtOnceTheImagesHaveMovedFar) {
  const testing::RenderedWalk fast = testing::render_walk(1.5, 90);
  int without_corners[2] = {};
  for (const bool far : {false, true}) {
    FrontTrackerOptions options = testing::replay_options();
    options.tracking.corner_interval_s = 10;
    options.keyframes.max_motion = far ? 0.2 : 0.01;
    Tracker tracker(fast.camera, options, 1);
    for (size_t i = 0; i < fast.images.size(); ++i) {
      const auto r = tracker.process(fast.utime_us[i], fast.images[i]);
      without_corners[far] += r->state == TrackingState::kTracking && r->keypoints <= 1.2 * r->inliers;
    }
    ASSERT_EQ(tracker.submaps().size(), 1u);
  }
  EXPECT_GT(without_corners[true], 1.5 * without_corners[false]);
  EXPECT_GT(without_corners[false], 20);
}

}  // namespace
}  // namespace rumi::front_tracker
