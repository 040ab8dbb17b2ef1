// SPDX-License-Identifier: BSD-3-Clause
// Bad images as cameras deliver them now and then. Poses that are given must be right, and tracking must be back as
// soon as the view is.
#include <gtest/gtest.h>

#include <functional>
#include <opencv2/imgproc.hpp>

#include "front_tracker/tracking/tracker.h"
#include "tests/front_tracker/rendered_walk.h"

namespace rumi::front_tracker {
namespace {

using testing::render_walk;
using testing::rendered_walk;
using testing::RenderedWalk;
using testing::replay_options;

struct Outcome {
  std::vector<TrackingState> states;
  size_t given = 0, with_pose = 0;
};

// Gives the tracker the images that `change` makes, at the times that `time` says, and checks all poses. If `change`
// returns an empty Mat, the image is dropped.
Outcome give(const RenderedWalk& walk, const std::function<cv::Mat(size_t)>& change,
             const std::function<int64_t(size_t)>& time = {}) {
  Tracker tracker(walk.camera, replay_options(), 1);
  Outcome outcome;
  std::map<int64_t, Eigen::Vector3d> center;
  for (size_t i = 0; i < walk.images.size(); ++i) {
    const cv::Mat image = change(i);
    if (image.empty()) continue;
    const int64_t utime_us = time ? time(i) : walk.utime_us[i];
    center[utime_us] = walk.center.at(walk.utime_us[i]);
    const auto result = tracker.process(utime_us, image);
    EXPECT_TRUE(result);
    outcome.states.push_back(result->state);
    ++outcome.given;
  }
  for (const auto& submap : tracker.submaps()) {
    const testing::Error error = testing::error_of(submap->map, center);
    EXPECT_LT(error.rmse_m, 0.02 * error.path_m)
        << "submap " << submap->map.key.id << ", " << error.frames << " frames";
    EXPECT_LT(error.worst_m, 0.15);
    outcome.with_pose += error.frames;
  }
  return outcome;
}

size_t tracked(const Outcome& outcome, size_t begin, size_t end) {
  return static_cast<size_t>(std::count(outcome.states.begin() + static_cast<long>(begin),
                                        outcome.states.begin() + static_cast<long>(end), TrackingState::kTracking));
}

const cv::Mat& image(size_t i) { return rendered_walk().images[i]; }
const size_t kBegin = 60, kEnd = 75;  // range of the images that are spoilt
bool in_passage(size_t i) { return i >= kBegin && i < kEnd; }

void expect_back(const Outcome& outcome) {
  EXPECT_EQ(tracked(outcome, 40, kBegin), kBegin - 40);
  EXPECT_GE(tracked(outcome, kEnd + 10, outcome.given), outcome.given - kEnd - 15);
}

TEST(HardInput, SaturatedImages) {
  expect_back(give(rendered_walk(), [](size_t i) {
    if (!in_passage(i)) return image(i);
    cv::Mat saturated;
    image(i).convertTo(saturated, CV_8U, 8, 60);
    return saturated;
  }));
}

TEST(HardInput, DarkImages) {
  expect_back(give(rendered_walk(), [](size_t i) {
    if (!in_passage(i)) return image(i);
    cv::Mat dark;
    image(i).convertTo(dark, CV_8U, 0.03);
    return dark;
  }));
}

// The hand is textured, nearer than everything else, and moves against the room.
TEST(HardInput, AHandOverHalfTheImage) {
  cv::Mat hand(240, 480, CV_8U);
  cv::RNG random(4);
  random.fill(hand, cv::RNG::UNIFORM, 0, 255);
  cv::GaussianBlur(hand, hand, {}, 2);
  cv::normalize(hand, hand, 20, 235, cv::NORM_MINMAX);
  const Outcome outcome = give(rendered_walk(), [&](size_t i) {
    if (!in_passage(i)) return image(i);
    cv::Mat covered = image(i).clone();
    hand(cv::Rect(static_cast<int>(8 * (i - kBegin)), 0, 160, 240)).copyTo(covered(cv::Rect(0, 0, 160, 240)));
    return covered;
  });
  expect_back(outcome);
}

TEST(HardInput, BurstsOfDroppedFrames) {
  const Outcome outcome = give(rendered_walk(), [](size_t i) { return i > 30 && i % 25 < 8 ? cv::Mat() : image(i); });
  EXPECT_GE(outcome.with_pose, outcome.given - 10);
}

TEST(HardInput, FiveFramesPerSecond) {
  const Outcome outcome = give(rendered_walk(), [](size_t i) { return i % 4 ? cv::Mat() : image(i); });
  EXPECT_GE(4 * outcome.with_pose, 3 * outcome.given);
}

TEST(HardInput, HundredAndTwentyFramesPerSecond) {
  const RenderedWalk walk = render_walk(1, 120);
  const Outcome outcome = give(walk, [&walk](size_t i) { return walk.images[i]; });
  EXPECT_GE(outcome.with_pose, outcome.given - 5);
}

TEST(HardInput, TimeJumps) {
  const Outcome outcome = give(
      rendered_walk(), [](size_t i) { return image(i); },
      [](size_t i) {
        return rendered_walk().utime_us[i] + (i < kBegin ? 0 : i < kEnd ? 3'600'000'000 : 3'600'400'000);
      });
  EXPECT_GE(outcome.with_pose, outcome.given - 5);
}

}  // namespace
}  // namespace rumi::front_tracker
