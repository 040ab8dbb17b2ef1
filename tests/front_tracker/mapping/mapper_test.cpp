// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "bus/wire/submap_update.h"
#include "front_tracker/mapping/mapper.h"
#include "front_tracker/matching/projection_search.h"
#include "front_tracker/relocalization/relocalizer.h"
#include "tests/front_tracker/feature_scene.h"
#include "tests/front_tracker/slip.h"

namespace rumi::front_tracker {
namespace {

std::vector<SE3> walk(int count) {
  std::vector<SE3> poses;
  poses.reserve(count);
  for (int i = 0; i < count; ++i) poses.push_back(SyntheticScene::pose(0.12 * i, 0.02 * i, 0.03 * i, -0.02 * i));
  return poses;
}

std::vector<const Landmark*> all_landmarks(const FrontSubmap& s) {
  std::vector<const Landmark*> landmarks;
  for (const auto& [id, lm] : s.map.landmarks) landmarks.push_back(&lm);
  return landmarks;
}

TEST(ProjectionSearch, FindsTheRightKeypoints) {
  FeatureScene scene(1);
  const auto s = scene.submap(walk(4));
  std::vector<int> point_of;
  const SE3 truth = SyntheticScene::pose(0.2, 0.02, 0, -0.03);
  Frame frame = scene.frame(1, truth, &point_of);
  // Turned by 0.02 rad, so that predictions are 10 to 15 px off.
  frame.cam_from_submap = SyntheticScene::pose(0.2, 0.02, 0, -0.01);
  std::vector<int> visible;
  const int found =
      search_by_projection(test_camera(), all_landmarks(*s), {.radius_px = 20}, s->octave_scales, &frame, &visible);
  EXPECT_GT(found, 0.9 * static_cast<double>(visible.size()));
  for (size_t i = 0; i < point_of.size(); ++i)
    if (frame.landmark_ids[i] != kNone) {
      ASSERT_NE(point_of[i], kNone);
      EXPECT_EQ(s->map.landmark(frame.landmark_ids[i])->position, scene.points()[point_of[i]]);
    }
  EXPECT_GT(refine_pose(test_camera(), s->map, s->octave_scales, &frame), 200);
  EXPECT_LT(rotation_error_deg(frame.cam_from_submap, truth), 0.1);
}

TEST(ProjectionSearch, SeesNothingBehindOrFromTheOtherSide) {
  FeatureScene scene(2);
  const auto s = scene.submap(walk(3));
  Frame frame = scene.frame(1, SE3());
  frame.cam_from_submap = SyntheticScene::pose(0, 0, 0, M_PI);
  EXPECT_EQ(search_by_projection(test_camera(), all_landmarks(*s), {}, s->octave_scales, &frame), 0);
  frame.cam_from_submap = SyntheticScene::pose(0, 0, 12, M_PI);
  EXPECT_EQ(search_by_projection(test_camera(), all_landmarks(*s), {}, s->octave_scales, &frame), 0);
}

TEST(Mapper, MakesTrueLandmarksAndImprovesWhatIsThere) {
  FeatureScene scene(3);
  const std::vector<SE3> poses = walk(6);
  auto s = scene.submap(poses);
  // Forget two thirds of the landmarks, and disturb the others and the younger keyframes.
  SyntheticScene random(4);
  for (int id = 0; id < 400; ++id) s->map.remove_landmark(id);
  for (auto& [id, lm] : s->map.landmarks) lm.position *= 1 + random.uniform(-0.03, 0.03);
  for (auto& [id, kf] : s->map.keyframes) {
    if (id < 2) continue;
    Vector6d twist;
    for (int i = 0; i < 6; ++i) twist[i] = random.uniform(-0.003, 0.003);
    kf.cam_from_submap = SE3::exp(twist) * kf.cam_from_submap;
  }
  const size_t before = s->map.landmarks.size();
  MappingOptions options;
  options.redundant_ratio = 1.0;  // every keyframe stays
  const Mapper mapper(test_camera(), options);
  std::mutex mutex;
  for (int id = 0; id < 6; ++id) mapper.process(*s, id, mutex);
  EXPECT_GT(s->map.landmarks.size(), before + 150);
  for (int id = 2; id < 6; ++id) {
    EXPECT_LT(rotation_error_deg(s->map.keyframe(id)->cam_from_submap, poses[id]), 0.2);
    EXPECT_LT((s->map.keyframe(id)->cam_from_submap.center() - poses[id].center()).norm(), 0.02);
  }
  int wrong = 0;
  for (const auto& [id, lm] : s->map.landmarks) {
    double nearest = 1e9;
    for (const Eigen::Vector3d& p : scene.points()) nearest = std::min(nearest, (p - lm.position).norm() / p.z());
    wrong += nearest > 0.25;  // max_log_distance admits 50 % for a pixel of noise; here it is half a pixel
  }
  EXPECT_LT(wrong, 0.02 * static_cast<double>(s->map.landmarks.size()));
}

// A place is known at its third visit, if ten seconds or more lie between two visits.
TEST(Mapper, AKnownPlaceGrowsOnlyWhereItIsNew) {
  constexpr int kNewest = 5;
  MappingOptions options;
  options.redundant_ratio = 1.0;  // every keyframe stays
  const Mapper mapper(test_camera(), options);
  std::mutex mutex;
  // Returns how many landmarks are made in the left and in the right half of the newest image, after every third
  // landmark was removed, or all of those in the right half.
  const auto made = [&](int64_t pause_us, bool right_is_unknown) {
    FeatureScene scene(3);
    auto s = scene.submap(walk(kNewest + 1));
    Keyframe& newest = *s->map.keyframe(kNewest);
    for (auto& [id, kf] : s->map.keyframes) kf.utime_us += id / 2 * pause_us;  // three visits
    const auto is_right = [&](const Eigen::Vector3d& position) {
      return test_camera().project_undistorted(newest.cam_from_submap * position).x() > 0.5 * test_camera().width;
    };
    std::vector<int> gone;
    for (const auto& [id, lm] : s->map.landmarks)
      if (right_is_unknown ? is_right(lm.position) : id % 3 == 0) gone.push_back(id);
    for (int id : gone) s->map.remove_landmark(id);
    const int before = s->map.landmarks.rbegin()->first;
    mapper.process(*s, kNewest, mutex);
    std::pair<int, int> count;
    for (const auto& [id, lm] : s->map.landmarks)
      if (id > before) ++(is_right(lm.position) ? count.second : count.first);
    return count;
  };
  const auto [left, right] = made(0, false);
  EXPECT_GT(left, 30);
  EXPECT_GT(right, 30);
  const auto [known_left, known_right] = made(20'000'000, false);
  EXPECT_LT(known_left, left / 5);
  EXPECT_LT(known_right, right / 5);
  EXPECT_GT(made(20'000'000, true).second, 100);
  EXPECT_GT(made(9'000'000, false).first, 30) << "one long visit";
}

// A landmark lies behind a camera that observes it. The solver would refuse to begin, in this and every later
// adjustment.
TEST(Mapper, PointBehindACameraIsPutRightAndStopsNothing) {
  FeatureScene scene(6);
  const std::vector<SE3> poses = walk(5);
  auto s = scene.submap(poses);
  SyntheticScene random(7);
  for (auto& [id, kf] : s->map.keyframes) {
    if (id < 2) continue;
    Vector6d twist;
    for (int i = 0; i < 6; ++i) twist[i] = random.uniform(-0.01, 0.01);
    kf.cam_from_submap = SE3::exp(twist) * kf.cam_from_submap;
  }
  const int lost = s->map.landmarks.begin()->first;
  s->map.landmark(lost)->position = {0, 0, -5};
  MappingOptions options;
  options.redundant_ratio = 1.0;  // every keyframe stays
  const Mapper mapper(test_camera(), options);
  std::mutex mutex;
  mapper.process(*s, 4, mutex);
  for (int id = 2; id < 5; ++id) {
    EXPECT_LT(rotation_error_deg(s->map.keyframe(id)->cam_from_submap, poses[id]), 0.1);
    EXPECT_LT((s->map.keyframe(id)->cam_from_submap.center() - poses[id].center()).norm(), 0.01);
  }
  EXPECT_FALSE(s->map.landmark(lost)) << "nothing sees it";
}

// The narrow adjustment leaves older keyframes where they are; the wide one, after every eighth keyframe, moves them.
TEST(Mapper, NowAndThenAdjustsAWideNeighbourhood) {
  FeatureScene scene(8);
  const std::vector<SE3> poses = walk(10);
  MappingOptions options;
  options.redundant_ratio = 1.0;  // every keyframe stays
  options.bundle_keyframes = 3;
  options.bundle_fixed_keyframes = 7;
  options.bundle_wide_every = 8;
  const auto error_after_keyframe = [&](int newest) {
    auto s = scene.submap(poses);
    Keyframe& old = *s->map.keyframe(3);
    old.cam_from_submap = SE3::exp((Vector6d() << .01, -.02, .01, .003, .004, -.003).finished()) * old.cam_from_submap;
    std::mutex mutex;
    Mapper(test_camera(), options).process(*s, newest, mutex);
    return (s->map.keyframe(3)->cam_from_submap.center() - poses[3].center()).norm();
  };
  EXPECT_GT(error_after_keyframe(8), .02);
  EXPECT_LT(error_after_keyframe(7), .005);
  options.bundle_wide_every = 0;
  EXPECT_GT(error_after_keyframe(7), .02);
}

TEST(Mapper, DropsRedundantKeyframesAndKeepsTheirFrames) {
  FeatureScene scene(5);
  std::vector<SE3> poses;
  poses.reserve(10);
  for (int i = 0; i < 10; ++i) poses.push_back(SyntheticScene::pose(0.02 * i, 0, 0));
  auto s = scene.submap(poses);
  const Mapper mapper(test_camera(), {});
  std::mutex mutex;
  mapper.process(*s, 9, mutex);
  EXPECT_LT(s->map.keyframes.size(), 10u);
  EXPECT_TRUE(s->map.keyframes.contains(0));
  ASSERT_EQ(s->map.frames.size(), 10u);
  for (const auto& [utime, frame] : s->map.frames) {
    ASSERT_NE(s->map.keyframe(frame.reference_keyframe), nullptr);
    const SE3& truth = poses[static_cast<size_t>(utime / 100'000 - 1)];
    EXPECT_LT((s->map.cam_from_submap(frame).center() - truth.center()).norm(), 0.02);
  }
}

TEST(Relocalizer, FindsTheCameraAndNeverInventsOne) {
  int found = 0, tried = 0;
  for (unsigned seed = 0; seed < 5; ++seed) {
    FeatureScene scene(seed), elsewhere(seed + 50);
    const auto s = scene.submap(walk(5));
    Relocalizer relocalizer(test_camera(), {}, test_octave_scales());
    for (const auto& [id, kf] : s->map.keyframes) relocalizer.add_keyframe(0, s->map, kf);
    SyntheticScene random(seed);
    for (int i = 0; i < 5; ++i) {
      const SE3 truth = SyntheticScene::pose(random.uniform(0, 0.5), random.uniform(-0.1, 0.1),
                                             random.uniform(-0.3, 0.3), random.uniform(-0.15, 0.1));
      const Frame frame = scene.frame(1, truth), foreign = elsewhere.frame(1, truth);
      ++tried;
      for (const auto& c : relocalizer.candidates(frame))
        if (const auto posed = relocalizer.relocalize(s->map, c.keyframe_id, frame)) {
          ++found;
          EXPECT_LT(rotation_error_deg(posed->cam_from_submap, truth), 0.3);
          EXPECT_LT((posed->cam_from_submap.center() - truth.center()).norm(), 0.03);
          break;
        }
      for (const auto& [id, kf] : s->map.keyframes) EXPECT_FALSE(relocalizer.relocalize(s->map, id, foreign));
    }
  }
  EXPECT_EQ(found, tried);
}

TEST(Relocalizer, SeesThatASubmapIsTorn) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    FeatureScene scene(seed);
    const std::vector<SE3> poses = walk(6);
    const auto s = scene.submap({poses.begin(), poses.begin() + 4});
    testing::append(*scene.submap({poses.begin() + 4, poses.end()}), s.get());
    const Relocalizer relocalizer(test_camera(), {}, test_octave_scales());
    const auto found = relocalizer.relocalize(s->map, 3, scene.frame(1, poses[3]));
    ASSERT_TRUE(found);
    const Frame& frame = *found;
    for (int id = 0; id < 6; ++id) EXPECT_FALSE(relocalizer.contradicts(s->map, id, frame)) << id;
    testing::slip(s.get(), 1'000'000);
    for (int id = 0; id < 6; ++id) EXPECT_EQ(relocalizer.contradicts(s->map, id, frame), id >= 4) << id;
    FeatureScene elsewhere(seed + 50);
    Frame foreign = elsewhere.frame(1, poses[3]);
    EXPECT_FALSE(relocalizer.contradicts(s->map, 5, foreign)) << "it sees nothing of that";
    EXPECT_FALSE(relocalizer.contradicts(s->map, 99, frame)) << "there is no such keyframe";
  }
}

TEST(FrontSubmap, ItsEndIsCutOffHereAndInCopies) {
  FeatureScene scene(3);
  auto s = scene.submap(walk(6));  // keyframes at 100, 200, ..., 600 ms
  ++s->map.revision;
  Submap copy;
  ASSERT_EQ(apply_submap_update(make_submap_update(s->map, 0), &copy).error_text(), "");
  ASSERT_EQ(copy.frames.size(), 6u);
  ++s->map.revision;
  s->cut_end(400'000);
  EXPECT_EQ(s->map.keyframes.size(), 3u);
  EXPECT_EQ(s->map.frames.size(), 3u);
  EXPECT_EQ(s->map.frames.rbegin()->first, 300'000);
  for (const auto& [id, lm] : s->map.landmarks) {
    EXPECT_GE(lm.observations.size(), 2u);
    for (const Observation& o : lm.observations) EXPECT_LT(o.keyframe_id, 3);
  }
  for (const auto& [utime, frame] : s->map.frames) EXPECT_NE(s->map.keyframe(frame.reference_keyframe), nullptr);
  ASSERT_EQ(apply_submap_update(make_submap_update(s->map, copy.revision), &copy).error_text(), "");
  EXPECT_EQ(copy.frames.size(), 3u);
  EXPECT_EQ(copy.keyframes.size(), 3u);
  EXPECT_EQ(copy.landmarks.size(), s->map.landmarks.size());
  Frame next = scene.frame(7'000'000, SE3());
  EXPECT_EQ(s->add_keyframe(&next).id, 6) << "no number is given twice";
}

TEST(Relocalizer, ForgetsKeyframesThatWereCulled) {
  FeatureScene scene(1);
  FrontSubmap first, second;
  Relocalizer relocalizer(test_camera(), {}, test_octave_scales());
  const auto add = [&](size_t index, FrontSubmap& submap) {
    Frame frame = scene.frame(1, SE3());
    relocalizer.add_keyframe(index, submap.map, submap.add_keyframe(&frame));
  };
  for (int i = 0; i < 3; ++i) add(0, first);
  add(1, second);
  EXPECT_EQ(relocalizer.size(), 4u);
  first.remove_keyframe(1, 0);
  add(1, second);
  EXPECT_EQ(relocalizer.size(), 5u) << "another submap's keyframes are not looked at";
  add(0, first);
  EXPECT_EQ(relocalizer.size(), 5u);
}

}  // namespace
}  // namespace rumi::front_tracker
