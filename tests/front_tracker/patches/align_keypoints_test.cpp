// SPDX-License-Identifier: BSD-3-Clause
// Compares keypoints of rendered images with the true epipolar geometry.
#include "front_tracker/patches/align_keypoints.h"

#include <gtest/gtest.h>

#include "front_tracker/matching/projection_search.h"
#include "slam/geometry/epipolar.h"
#include "slam/numeric/median.h"
#include "tests/front_tracker/walk_submap.h"

namespace rumi::front_tracker {
namespace {

using testing::frame_of;
using testing::submap_of;
using testing::walk;

// Returns the median distance of the frame's keypoints from the true epipolar lines of the keypoints of keyframe 0 that
// observe the same landmarks, in pixels of their level.
double epipolar_error(const FrontSubmap& s, const Features& features, const std::vector<int>& landmark_ids,
                      const SE3& cam_from_room) {
  const Keyframe& kf = *s.map.keyframe(0);
  const Eigen::Matrix3d f = fundamental_matrix(s.map.camera, cam_from_room * kf.cam_from_submap.inverse());
  std::vector<double> errors;
  for (size_t i = 0; i < landmark_ids.size(); ++i) {
    if (landmark_ids[i] == kNone) continue;
    const Observation& o = s.map.landmark(landmark_ids[i])->observations.front();
    const Eigen::Vector2f p = kf.features->undistorted[o.keypoint_index], q = features.undistorted[i];
    const Eigen::Vector3d line = f * Eigen::Vector3d(p.x(), p.y(), 1);
    errors.push_back(std::abs(line.dot(Eigen::Vector3d(q.x(), q.y(), 1))) / line.head<2>().norm() /
                     s.octave_scales[features.keypoints[i].octave]);
  }
  EXPECT_GT(errors.size(), 50u);
  return median(&errors);
}

TEST(AlignKeypoints, BringsAFrameNearerToTheTruth) {
  const auto s = submap_of({20, 32});
  Frame frame = frame_of(40);
  PatchTemplates templates;
  std::vector<const Landmark*> landmarks;
  for (const auto& [id, lm] : s->map.landmarks) landmarks.push_back(&lm);
  search_by_projection(walk().camera, landmarks, {.radius_px = 4}, s->octave_scales, &frame);
  const Features before = *frame.features;
  const double error = epipolar_error(*s, before, frame.landmark_ids, frame.cam_from_submap);
  align_keypoints(*s, &frame, &templates);
  const double aligned = epipolar_error(*s, *frame.features, frame.landmark_ids, frame.cam_from_submap);
  EXPECT_LT(aligned, 0.5 * error) << error << " px before, " << aligned << " px after";
  for (size_t i = 0; i < frame.landmark_ids.size(); ++i) {
    if (frame.landmark_ids[i] != kNone) continue;
    EXPECT_EQ(frame.features->keypoints[i].pixel, before.keypoints[i].pixel) << "matched to nothing";
  }
}

TEST(AlignKeypoints, WithoutImagesNothingMoves) {
  const auto s = submap_of({20, 32});
  Frame frame = frame_of(40);
  PatchTemplates templates;
  for (size_t i = 0; i < frame.landmark_ids.size(); ++i) frame.landmark_ids[i] = static_cast<int>(i % 50);
  const auto features = frame.features;
  frame.images.reset();
  align_keypoints(*s, &frame, &templates);
  EXPECT_EQ(frame.features, features);
  frame = frame_of(40);
  s->keep_images(0);
  align_keypoints(*s, &frame, &templates);
  for (size_t i = 0; i < frame.features->size(); ++i)
    EXPECT_EQ(frame.features->keypoints[i].pixel, features->keypoints[i].pixel);
}

// Templates are kept from frame to frame as long as the patches hardly change, and forgotten after some frames without
// use.
TEST(PatchTemplates, AreKeptWhileTheyFit) {
  const auto s = submap_of({20, 32});
  const ImagePyramid& images = *s->images.at(0);
  const PatchTemplates::Patch patch{{0, 5}, {160, 120}, Eigen::Matrix2f::Identity(), 1};
  PatchTemplates templates;
  const PatchTemplate* const first = templates.find(images, patch);
  ASSERT_NE(first, nullptr);
  const PatchTemplate::Patch grey = first->grey;
  templates.end_frame();

  PatchTemplates::Patch turned_a_little = patch, turned = patch, moved = patch, coarser = patch, outside = patch;
  turned_a_little.frame_from_keyframe(0, 1) = 0.01F;
  EXPECT_EQ(templates.find(images, turned_a_little)->grey, grey);
  turned.frame_from_keyframe(0, 1) = 0.05F;
  moved.pixel.x() += 0.5F;
  for (const PatchTemplates::Patch& other : {turned, moved}) {
    EXPECT_NE(templates.find(images, other)->grey, grey);
    EXPECT_EQ(templates.find(images, patch)->grey, grey) << "made once more";
  }
  EXPECT_EQ(templates.size(), 1u);
  coarser.octave = 2;
  EXPECT_NE(templates.find(images, coarser)->grey, grey);
  EXPECT_EQ(templates.size(), 2u) << "beside the other";
  outside.seen.keypoint_index = 6;
  outside.pixel = {1, 1};
  EXPECT_EQ(templates.find(images, outside), nullptr);
  EXPECT_EQ(templates.find(images, outside), nullptr) << "and again";
  EXPECT_EQ(templates.size(), 3u);
  templates.end_frame();
  for (int frame = 0; frame < 20; ++frame) {
    templates.find(images, patch);
    templates.end_frame();
  }
  EXPECT_EQ(templates.size(), 1u);
  for (int frame = 0; frame < 20; ++frame) templates.end_frame();
  EXPECT_EQ(templates.size(), 0u);
}

TEST(KeyframeAligner, FeaturesOfAKeyframeThatChangedAreSentAgainOnceTheyAreFinal) {
  const auto s = submap_of({20, 32, 40});
  const std::shared_ptr<const Features> before = s->map.keyframe(1)->features;
  int moved = 0;
  {
    KeyframeAligner aligner(*s, 1);
    for (const auto& [id, lm] : s->map.landmarks)
      moved += aligner.align(lm.observations[1].keypoint_index, lm.position, lm.observations);
  }
  EXPECT_GT(moved, 0.6 * static_cast<double>(s->map.landmarks.size()));
  EXPECT_NE(s->map.keyframe(1)->features, before) << "whoever holds the old ones keeps them";
  const std::vector<int>& landmark_ids = s->map.keyframe(1)->landmark_ids;
  const SE3& pose = s->map.keyframe(1)->cam_from_submap;
  const double error = epipolar_error(*s, *before, landmark_ids, pose),
               aligned = epipolar_error(*s, *s->map.keyframe(1)->features, landmark_ids, pose);
  EXPECT_LT(aligned, 0.5 * error) << error << " px before, " << aligned << " px after";

  s->map.revision = 7;
  s->keep_images(2);  // images of the newest two, so keyframe 1 may still change
  EXPECT_EQ(s->images.size(), 2u);
  EXPECT_EQ(s->map.keyframe(0)->created_revision, 1) << "nothing of it was moved";
  EXPECT_EQ(s->map.keyframe(1)->created_revision, 1);
  s->map.revision = 8;
  s->keep_images(1);
  EXPECT_EQ(s->map.keyframe(1)->created_revision, 8);
  EXPECT_EQ(s->map.keyframe(1)->revision, 8);
  s->map.revision = 9;
  s->keep_images(0);
  EXPECT_EQ(s->map.keyframe(1)->created_revision, 8) << "once";
  EXPECT_EQ(s->map.keyframe(2)->created_revision, 1);
  KeyframeAligner late(*s, 2);
  EXPECT_FALSE(late.align(0, s->map.landmarks.begin()->second.position, {{0, 0}}));
}

}  // namespace
}  // namespace rumi::front_tracker
