// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/patches/patch_search.h"

#include <gtest/gtest.h>

#include <set>

#include "slam/numeric/median.h"
#include "tests/front_tracker/walk_submap.h"

namespace rumi::front_tracker {
namespace {

using testing::expect_consistent;
using testing::frame_of;
using testing::median_shift;
using testing::submap_of;
using testing::walk;

std::vector<int> all_landmarks(const FrontSubmap& s) {
  std::vector<int> ids;
  for (const auto& [id, lm] : s.map.landmarks) ids.push_back(id);
  return ids;
}

// Returns the median distance of the added keypoints from the landmarks' pixels at the true pose, in pixels of their
// level. The landmarks have errors of their own.
double median_error(const FrontSubmap& s, const Frame& frame, size_t added, const SE3& cam_from_room) {
  std::vector<double> errors;
  for (size_t i = frame.features->size() - added; i < frame.features->size(); ++i) {
    const Eigen::Vector3d p = cam_from_room * s.map.landmark(frame.landmark_ids[i])->position;
    errors.push_back((walk().camera.project_undistorted(p) - frame.features->undistorted[i].cast<double>()).norm() /
                     s.octave_scales[frame.features->keypoints[i].octave]);
  }
  return median(&errors);
}

TEST(PatchSearch, FindsLandmarksAFewPixelsFromWhereThePosePutsThem) {
  const auto s = submap_of({20, 32});
  Frame frame = frame_of(40);
  const SE3 truth = frame.cam_from_submap;
  frame.cam_from_submap = SE3::exp((Vector6d() << 0, 0, 0, 0.008, -0.008, 0).finished()) * truth;
  const size_t corners = frame.features->size();
  PatchTemplates templates;
  const int added = search_by_patch(*s, all_landmarks(*s), 10000, &frame, &templates);
  EXPECT_GT(added, 0.4 * static_cast<double>(s->map.landmarks.size()));
  EXPECT_EQ(frame.matches(), added);
  EXPECT_EQ(frame.features->size(), corners + added);
  expect_consistent(frame);
  EXPECT_LT(median_error(*s, frame, added, truth), 0.7) << "px; the pose is off by 3 px";
  const std::set<int> once(frame.landmark_ids.begin(), frame.landmark_ids.end());
  EXPECT_EQ(once.size(), static_cast<size_t>(added) + 1) << "each landmark once, and kNone";
  EXPECT_GT(median_shift(*s, frame, truth), 2) << "px";
  EXPECT_GE(refine_pose(walk().camera, s->map, s->octave_scales, &frame), 0.9 * added);
  EXPECT_LT(median_shift(*s, frame, truth), 0.7) << "px";
}

TEST(PatchSearch, MostSeenFirstAndNoMoreThanWanted) {
  const auto s = submap_of({20, 32});
  const int often = s->map.landmarks.rbegin()->first;
  Frame frame = frame_of(32), third = frame_of(36);
  const int keyframe = s->add_keyframe(&third).id;
  s->map.add_observation(often, keyframe, 7);
  PatchTemplates templates;
  ASSERT_EQ(search_by_patch(*s, all_landmarks(*s), 1, &frame, &templates), 1);
  EXPECT_EQ(frame.landmark_ids.back(), often);
  EXPECT_EQ(frame.features->descriptors.back(), third.features->descriptors[7]) << "as it was seen last";
  EXPECT_EQ(search_by_patch(*s, all_landmarks(*s), 20, &frame, &templates), 19) << "one there is";
  EXPECT_EQ(search_by_patch(*s, all_landmarks(*s), 20, &frame, &templates), 0);
  expect_consistent(frame);
}

// Nothing is found if the image shows something else, if another landmark has a keypoint there, or without images.
TEST(PatchSearch, FindsNothingElsewhere) {
  const auto s = submap_of({20, 32});
  PatchTemplates templates;
  Frame elsewhere = frame_of(40);
  elsewhere.cam_from_submap = SE3::exp((Vector6d() << 0, 0, 0, 0.05, 0.1, 0).finished()) * elsewhere.cam_from_submap;
  const int by_chance = search_by_patch(*s, all_landmarks(*s), 10000, &elsewhere, &templates);
  EXPECT_LT(by_chance, 0.05 * static_cast<double>(s->map.landmarks.size()));

  Frame matched = frame_of(32);
  const Keyframe& same = *s->map.keyframe(1);
  matched.landmark_ids = same.landmark_ids;
  for (int& id : matched.landmark_ids)
    if (id != kNone) id += 100000;  // other landmarks, at the same places
  EXPECT_LT(search_by_patch(*s, all_landmarks(*s), 200000, &matched, &templates), 10);

  Frame without = frame_of(40);
  without.images.reset();
  EXPECT_EQ(search_by_patch(*s, all_landmarks(*s), 10000, &without, &templates), 0);
  Frame frame = frame_of(40);
  EXPECT_EQ(search_by_patch(*s, {-5, 1 << 30}, 10000, &frame, &templates), 0) << "no such landmarks";
  s->keep_images(0);
  EXPECT_EQ(search_by_patch(*s, all_landmarks(*s), 10000, &frame, &templates), 0);
}

}  // namespace
}  // namespace rumi::front_tracker
