// SPDX-License-Identifier: BSD-3-Clause
// Tests how front_tracker looks at its images: masks that come with them, parts that never move, and images that repeat
// the one before.
#include <gmock/gmock.h>

#include <opencv2/imgproc.hpp>

#include "lcmtypes/rumi/mask_t.hpp"
#include "tests/front_tracker/front_tracker_node_fixture.h"
#include "tests/support/captured_log.h"

namespace rumi::front_tracker {
namespace {

using ::testing::ElementsAre;
using testing::FrontTrackerNodeTest;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

// Returns how many keypoints of landmarks lie in the rows from `first` to the one before `end`.
int landmarks_seen(const Submap& map, float first, float end) {
  int seen = 0;
  for (const auto& [id, landmark] : map.landmarks)
    for (const Observation& o : landmark.observations) {
      const float y = map.keyframe(o.keyframe_id)->features->keypoints[o.keypoint_index].pixel.y();
      seen += y >= first - 0.5F && y < end - 0.5F;
    }
  return seen;
}

class NodeWithMasks : public FrontTrackerNodeTest {
 protected:
  void give_masked_walk(double seconds, const cv::Mat& mask) {
    synth::SequenceRenderer renderer(walk(seconds));
    for (int i = 0; i < renderer.frames(); ++i) {
      image_t message = image(renderer.utime_us(i), renderer.render(i));
      set_metadata(&message, kMaskKey, encode_mask(mask));
      give(message);
    }
  }
};

TEST_F(NodeWithMasks, WhereAMaskIsBlackThereAreNoLandmarks) {
  cv::Mat mask(240, 320, CV_8U, cv::Scalar(255));
  mask.rowRange(0, 120).setTo(0);
  const testing::CapturedLog log;
  give_masked_walk(1.5, mask);
  ASSERT_EQ(node_->tracker()->submaps().size(), 1u);
  const Submap& map = node_->tracker()->submaps()[0]->map;
  EXPECT_GE(map.keyframes.size(), 2u);
  EXPECT_EQ(landmarks_seen(map, 0, 120), 0);
  EXPECT_GT(landmarks_seen(map, 120, 240), 200);
  EXPECT_THAT(log.text(), Not(HasSubstr("mask")));
}

TEST_F(NodeWithMasks, AMaskOfAnotherSizeIsToldOnceAndIgnored) {
  const testing::CapturedLog log;
  give_masked_walk(1.2, cv::Mat::zeros(120, 160, CV_8U));
  const std::string said = "the mask is 160 x 120 pixels and the image 320 x 240";
  EXPECT_THAT(log.text(), HasSubstr(said));
  EXPECT_EQ(log.text().find(said), log.text().rfind(said)) << "once";
  ASSERT_EQ(node_->tracker()->submaps().size(), 1u);
  EXPECT_GT(landmarks_seen(node_->tracker()->submaps()[0]->map, 0, 240), 200);
}

TEST_F(FrontTrackerNodeTest, OfARowOfTheSameImagesTwoHaveAPose) {
  synth::SequenceRenderer renderer(walk(1.5));
  const int still = 25;  // the first image that repeats the one before
  for (int i = 0; i < still; ++i) give(image(renderer.utime_us(i), renderer.render(i)));
  ASSERT_EQ(tracks_.back().state, track_t::TRACKING);
  EXPECT_THAT(node_->complaints(), IsEmpty());
  const size_t before = tracks_.size();
  const cv::Mat last = renderer.render(still - 1);
  for (int i = still; i < still + 4; ++i) give(image(renderer.utime_us(i), last));
  ASSERT_EQ(tracks_.size(), before + 2);
  for (size_t i = before; i < tracks_.size(); ++i) {
    EXPECT_EQ(tracks_[i].utime, renderer.utime_us(still + static_cast<int>(i - before)));
    EXPECT_EQ(tracks_[i].state, track_t::TRACKING);
    EXPECT_NE(tracks_[i].submap_id, kNoSubmap);
    EXPECT_FALSE(tracks_[i].is_keyframe);
    EXPECT_GT(tracks_[i].position_sigma, tracks_[before - 1].position_sigma);
  }
  EXPECT_EQ(node_->repeated().doubled(), 2);
  EXPECT_EQ(node_->repeated().still(), 2);
  EXPECT_THAT(node_->complaints(), ElementsAre(HasSubstr("2 images are the same as the one before")));
  EXPECT_THAT(node_->status().detail, HasSubstr("2 images are the same as the one before; the longest row: 4 from"));
}

TEST_F(FrontTrackerNodeTest, DoubledImagesAloneAreNothingToComplainOf) {
  synth::SequenceRenderer renderer(walk(1.5));
  for (int i = 0; i < renderer.frames(); ++i) give(image(renderer.utime_us(i), renderer.render(i - i % 5 / 4)));
  EXPECT_EQ(node_->repeated().doubled(), renderer.frames() / 5);
  EXPECT_EQ(tracks_.back().state, track_t::TRACKING);
  EXPECT_THAT(node_->complaints(), IsEmpty());
  EXPECT_THAT(node_->status().detail, Not(HasSubstr("the same")));
}

TEST_F(FrontTrackerNodeTest, WhatNeverMovesIsPublishedAndIsNoLandmark) {
  std::vector<mask_t> masks;
  bus_.subscribe<mask_t>(channels::kMask, {}, [&](const mask_t& m) { masks.push_back(m); });
  cv::Mat caption(32, 320, CV_8U);
  cv::RNG rng(1);
  rng.fill(caption, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(caption, caption, {}, 2);
  cv::normalize(caption, caption, 0, 255, cv::NORM_MINMAX);
  synth::SynthOptions options = walk(5);
  options.rate_hz = 10;
  synth::SequenceRenderer renderer(options);
  const testing::CapturedLog log;
  for (int i = 0; i < renderer.frames(); ++i) {
    cv::Mat grey = renderer.render(i);
    caption.copyTo(grey.rowRange(208, 240));
    give(image(renderer.utime_us(i), grey));
  }
  ASSERT_FALSE(masks.empty());
  EXPECT_THAT(log.text(), HasSubstr("of the image never moves"));
  const mask_t& told = masks.back();
  EXPECT_EQ(told.session, tracks_.back().session);
  EXPECT_EQ(told.width, 320);
  EXPECT_EQ(told.height, 240);
  const cv::Mat pixels = decode_mask(std::string(told.png.begin(), told.png.end())).value();
  ASSERT_EQ(pixels.size(), cv::Size(320, 240));
  EXPECT_NEAR(told.left_out, ImageMask(pixels).left_out(), 1e-9);
  EXPECT_LT(cv::countNonZero(pixels.rowRange(208, 240)), 0.05 * 32 * 320);
  EXPECT_GT(cv::countNonZero(pixels.rowRange(0, 180)), 0.9 * 180 * 320);
  for (const auto& submap : node_->tracker()->submaps()) {
    const int bar = landmarks_seen(submap->map, 212, 240), all = landmarks_seen(submap->map, 0, 240);
    EXPECT_LT(bar, 0.05 * all);
  }
}

}  // namespace
}  // namespace rumi::front_tracker
