// SPDX-License-Identifier: BSD-3-Clause
// Tests the tracker's answer to an image that repeats the last one.
#include <gtest/gtest.h>

#include "front_tracker/tracking/tracker.h"
#include "tests/front_tracker/rendered_walk.h"

namespace rumi::front_tracker {
namespace {

const testing::RenderedWalk& sequence() {
  static const testing::RenderedWalk walk = testing::render_walk(1.5, 20);
  return walk;
}

class TrackerPredict : public ::testing::Test {
 protected:
  std::optional<TrackResult> process(size_t i) {
    return tracker_.process(sequence().utime_us[i], sequence().images[i]);
  }
  // Processes all images before this one. Returns the result for the last one.
  TrackResult track_until(size_t end) {
    std::optional<TrackResult> last;
    for (size_t i = 0; i < end; ++i) last = process(i);
    return last.value_or(TrackResult());
  }

  Tracker tracker_{sequence().camera, testing::replay_options(), 1};
};

TEST_F(TrackerPredict, TheMotionGoesOnAndIsLessSure) {
  const TrackResult earlier = track_until(24), before = process(24).value();
  ASSERT_EQ(before.state, TrackingState::kTracking);
  const auto doubled = tracker_.predict(sequence().utime_us[25]);
  ASSERT_TRUE(doubled);
  EXPECT_EQ(doubled->utime_us, sequence().utime_us[25]);
  EXPECT_EQ(doubled->state, TrackingState::kTracking);
  EXPECT_EQ(doubled->submap_id, before.submap_id);
  EXPECT_FALSE(doubled->is_keyframe);
  EXPECT_GT(doubled->sigmas.position, before.sigmas.position);
  EXPECT_GT(doubled->sigmas.rotation_rad, before.sigmas.rotation_rad);
  const Submap& map = tracker_.submaps()[0]->map;
  EXPECT_TRUE(map.frame(sequence().utime_us[25])) << "it is one of the submap's frames";

  const SE3 last = map.cam_from_submap(*map.frame(sequence().utime_us[24]));
  const SE3 moved = doubled->cam_from_submap * last.inverse();
  const SE3 moved_before = before.cam_from_submap * earlier.cam_from_submap.inverse();
  EXPECT_LT((moved.translation - moved_before.translation).norm(), 0.5 * moved_before.translation.norm());
  EXPECT_LT((moved * moved_before.inverse()).angle_rad(), 0.5 * moved_before.angle_rad());

  const auto next = process(26);
  ASSERT_TRUE(next);
  EXPECT_EQ(next->state, TrackingState::kTracking) << "tracking goes on";
  EXPECT_EQ(next->submap_id, before.submap_id);
}

TEST_F(TrackerPredict, NothingIsKnownBeforeItTracks) {
  EXPECT_FALSE(tracker_.predict(sequence().utime_us[0]));
  const TrackResult first = track_until(1);
  ASSERT_EQ(first.state, TrackingState::kNotInitialized);
  EXPECT_FALSE(tracker_.predict(sequence().utime_us[1]));
}

TEST_F(TrackerPredict, NothingIsKnownOfOlderImages) {
  const TrackResult before = track_until(20);
  ASSERT_EQ(before.state, TrackingState::kTracking);
  EXPECT_FALSE(tracker_.predict(before.utime_us));
  EXPECT_TRUE(tracker_.predict(before.utime_us + 20'000));
  EXPECT_FALSE(tracker_.predict(before.utime_us + 20'000)) << "it has been predicted";
  EXPECT_FALSE(tracker_.process(before.utime_us + 10'000, sequence().images[20]));
}

TEST_F(TrackerPredict, NothingIsKnownOnceItIsLost) {
  track_until(20);
  const auto dark = tracker_.process(sequence().utime_us[20], cv::Mat(240, 320, CV_8U, cv::Scalar(0)));
  ASSERT_TRUE(dark);
  ASSERT_EQ(dark->state, TrackingState::kRecentlyLost);
  EXPECT_FALSE(tracker_.predict(sequence().utime_us[21]));
}

}  // namespace
}  // namespace rumi::front_tracker
