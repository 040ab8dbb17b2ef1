// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/tracking/loss.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "front_tracker/tracking/tracker.h"
#include "tests/front_tracker/rendered_walk.h"
#include "tests/support/captured_log.h"
#include "tests/support/count_of.h"

namespace rumi::front_tracker {
namespace {

using ::testing::AllOf;
using testing::count_of;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(Loss, IsDescribedInOneLine) {
  Loss loss{.first_utime_us = 1'400'000'000'000'000,
            .utime_us = 1'400'000'011'230'000,
            .submap_id = 1,
            .frames_before = 512,
            .why = "",
            .images = 34,
            .outcome = "found again in submap 1"};
  EXPECT_EQ(describe(loss, 1'400'000'013'130'000),
            "lost at 11.23 s (utime 1400000011230000) after 512 images in submap 1: 34 images, 1.9 s; "
            "found again in submap 1");
  loss.posed_afterwards = 12;
  loss.withdrawn = 3;
  EXPECT_THAT(
      describe(loss, 1'400'000'013'130'000),
      HasSubstr("34 images, 1.9 s, 12 of them with a pose by now; the poses of 3 images before contradict where "
                "it was found: withdrawn; found again"));
}

// Returns what the tracker logs at this level and above during the walk. In its middle, the lens is covered for
// `covered` images.
std::string said(spdlog::level::level_enum level, const FrontTrackerOptions& options, size_t covered, size_t end) {
  const testing::RenderedWalk& walk = testing::rendered_walk();
  const testing::CapturedLog log(level);
  Tracker tracker(walk.camera, options, 1);
  const cv::Mat black(walk.images[0].size(), CV_8U, cv::Scalar(0));
  const size_t cover = walk.images.size() / 2;
  for (size_t i = 0; i < end; ++i) {
    const bool is_covered = i >= cover && i < cover + covered;
    tracker.process(walk.utime_us[i], is_covered ? black : walk.images[i]);
  }
  tracker.end();
  return log.text();
}

std::string said_when_covered(size_t covered, size_t end) {
  return said(spdlog::level::info, testing::replay_options(), covered, end);
}

TEST(Loss, IsOneLineHoweverManyImagesItTakes) {
  const std::string text = said_when_covered(10, testing::rendered_walk().images.size());
  EXPECT_EQ(count_of(text, "lost at"), 1u) << text;
  EXPECT_THAT(text, HasSubstr("; found again in submap 1"));
  EXPECT_EQ(count_of(text, "\n"), 2u) << "and that the submap began: " << text;
}

TEST(Loss, ASingleImageIsNotWorthALine) {
  const std::string text = said_when_covered(1, testing::rendered_walk().images.size());
  EXPECT_THAT(text, AllOf(HasSubstr("submap 1 begins at"), Not(HasSubstr("lost"))));
}

TEST(Loss, ThatIsNotOverIsSaidAtTheEnd) {
  const size_t cover = testing::rendered_walk().images.size() / 2;
  EXPECT_THAT(said_when_covered(100, cover + 5),
              HasSubstr("5 images, 0.2 s (too few landmarks agree); not found again until the end"));
}

// No pose carries the scale on, but relocalization finds the camera in the same image.
TEST(Loss, WhatRelocalizationWouldFindInTheSameImageIsNone) {
  FrontTrackerOptions options = testing::replay_options();
  options.tracking.max_scale_drift = 1e-6;
  const std::string text = said(spdlog::level::debug, options, 0, testing::rendered_walk().images.size());
  EXPECT_GT(count_of(text, "found by another look"), 5u) << "the test shows nothing";
  EXPECT_EQ(count_of(text, ": 0 images"), 0u) << text;
}

}  // namespace
}  // namespace rumi::front_tracker
