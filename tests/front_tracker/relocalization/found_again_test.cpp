// SPDX-License-Identifier: BSD-3-Clause
// A camera is carried off in the dark, and comes back to known things from places where it has not been.
#include <gtest/gtest.h>

#include "front_tracker/tracking/tracker.h"
#include "tests/front_tracker/rendered_walk.h"

namespace rumi::front_tracker {
namespace {

const testing::RenderedWalk& walk() { return testing::rendered_walk(); }

struct Return {
  std::vector<int64_t> back_us;         // times of the images after the darkness; the camera is found in the last
  std::vector<TrackResult> afterwards;  // results that the last image brought for the others
  testing::Error error;                 // error of the submap, including the way back
};

// Gives a tracker the walk up to `known`, darkness, and the images from `from` backwards until the camera is found.
Return come_back(const FrontTrackerOptions& options, size_t known, size_t from) {
  constexpr int64_t kPeriod_us = 50'000;
  Tracker tracker(walk().camera, options, 1);
  std::map<int64_t, Eigen::Vector3d> center = walk().center;
  for (size_t i = 0; i < known; ++i) tracker.process(walk().utime_us[i], walk().images[i]);
  int64_t utime_us = walk().utime_us.back();
  const cv::Mat black(walk().images[0].size(), CV_8U, cv::Scalar(0));
  for (int i = 0; i < 25; ++i) tracker.process(utime_us += kPeriod_us, black);
  Return result;
  for (size_t i = from; i-- > 0;) {
    const auto r = tracker.process(utime_us += kPeriod_us, walk().images[i]);
    result.back_us.push_back(utime_us);
    center[utime_us] = walk().center.at(walk().utime_us[i]);
    if (r->submap_id == kNoSubmap) continue;
    EXPECT_EQ(r->submap_id, 1);
    break;
  }
  result.afterwards = tracker.posed_afterwards();
  EXPECT_EQ(tracker.submaps().size(), 1u);
  result.error = testing::error_of(tracker.submaps()[0]->map, center);
  return result;
}

FrontTrackerOptions only_found_again() {
  FrontTrackerOptions options = testing::replay_options();
  options.tracking.recently_lost_s = 60;  // longer than the walk, so that no new submap begins
  return options;
}

TEST(FoundAgain, FromElsewhereAsSoonAsEnoughAgrees) {
  FrontTrackerOptions options = only_found_again();
  const Return soon = come_back(options, 70, 90);
  EXPECT_LT(soon.error.worst_m, 0.02 * soon.error.path_m);
  options.tracking.uncertain_px = 0.01;
  EXPECT_LT(soon.back_us.size(), come_back(options, 70, 90).back_us.size())
      << "a pose that is certain takes a third of what should be in view";
}

// If many inliers are required, the camera is found later, but the images before get their poses, too.
TEST(FoundAgain, ImagesBeforeAreTrackedBack) {
  FrontTrackerOptions options = only_found_again();
  const size_t soon = come_back(options, 70, 90).back_us.size();
  options.tracking.relocalization_min_inliers = 200;
  const Return late = come_back(options, 70, 90);
  ASSERT_GT(late.back_us.size(), soon + 5);
  const size_t count = late.afterwards.size();
  EXPECT_GE(count, late.back_us.size() - soon - 2);
  EXPECT_EQ(late.error.frames, 70 + count + 1);
  EXPECT_LT(late.error.worst_m, 0.02 * late.error.path_m);
  for (size_t i = 0; i < count; ++i) {
    const TrackResult& r = late.afterwards[i];
    EXPECT_EQ(r.utime_us, late.back_us[late.back_us.size() - 1 - count + i]) << "in order of time, without a gap";
    EXPECT_EQ(r.submap_id, 1);
    EXPECT_GE(r.inliers, 10);
  }
}

}  // namespace
}  // namespace rumi::front_tracker
