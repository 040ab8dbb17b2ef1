// SPDX-License-Identifier: BSD-3-Clause
#include "ruminator/ruminator_node.h"

#include <gmock/gmock.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <random>

#include "bus/wire/image_masks.h"
#include "ruminator/window/window_message.h"
#include "tests/ruminator/ruminator_node_fixture.h"

namespace rumi::ruminator {
namespace {

using ::testing::HasSubstr;
using testing::kPeriodUs;
using testing::RuminatorNodeTest;

TEST_F(RuminatorNodeTest, AWindowIsAnnouncedFromBeginningToEnd) {
  start();
  frames(100, 1);
  EXPECT_TRUE(announced_.empty());
  frames(60, kNoSubmap);  // 60 frames are 2 s
  frames(60, 2);
  ASSERT_GE(announced_.size(), 4);
  EXPECT_EQ(announced_[0].state, window_t::COLLECTING);
  EXPECT_EQ(announced_[0].lost_utime, 1'000'000 + 101 * kPeriodUs);
  EXPECT_EQ(announced_[0].submap_before, 1);
  EXPECT_EQ(announced_[0].submap_after, kNoSubmap);
  EXPECT_EQ(announced_[0].ngap, 1);
  EXPECT_EQ(announced_[1].state, window_t::COLLECTING);  // announced again 1 s later
  EXPECT_GE(announced_[1].utime - announced_[0].utime, 1'000'000);
  const window_t& end = announced_.back();
  EXPECT_EQ(end.state, window_t::QUEUED);
  EXPECT_EQ(end.window_id, 1);
  EXPECT_EQ(end.session, 7);
  EXPECT_EQ(end.submap_after, 2);
  EXPECT_EQ(end.ngap, 60);
  EXPECT_EQ(end.gap_frames, 60);
  EXPECT_EQ(end.napproach, 15);
  EXPECT_EQ(end.shared_keyframes_before, 14);  // the 15th sample is the last tracked frame
  EXPECT_EQ(end.shared_keyframes_after, 10);
  EXPECT_EQ(end.reason, "");
  const auto resumed =
      std::find_if(announced_.begin(), announced_.end(), [](const window_t& w) { return w.resumed_utime != 0; });
  EXPECT_EQ(resumed->state, window_t::COLLECTING);
  ASSERT_EQ(jobs_.size(), 1);
  expect_images_of(jobs_[0]);
  EXPECT_FALSE(node_->status().degraded);
}

TEST_F(RuminatorNodeTest, WhatTheBuilderDoesWithoutIsInTheStatusWhileItIsSo) {
  start();
  builder_problem_ = "COLMAP: not found in PATH";
  EXPECT_TRUE(node_->status().degraded);
  EXPECT_THAT(node_->status().detail, ::testing::StartsWith("COLMAP: not found in PATH; no window open"));
  builder_problem_.clear();
  EXPECT_FALSE(node_->status().degraded);
}

TEST_F(RuminatorNodeTest, AWindowHasImagesOfItsOwnStreamOnly) {
  start();
  stream_ = 5;
  frames(20, 1);
  frames(5, kNoSubmap);
  now_ = 1'000'000;  // another recording of the same times
  stream_ = 6;
  frames(20, 1);
  frames(5, kNoSubmap);
  frames(60, 2);
  ASSERT_EQ(jobs_.size(), 2);
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(jobs_[i].window.stream, i == 0 ? 5 : 6);
    expect_images_of(jobs_[i]);
    for (const image_t& image : jobs_[i].images) EXPECT_EQ(stream_of(image), jobs_[i].window.stream);
  }
}

// Makes a mask that masks the upper half. Its size may be that of the images, or their working size.
mask_t learned_mask(int64_t stream, int64_t utime_us, int width = 160, int height = 120) {
  cv::Mat world(height, width, CV_8U, cv::Scalar(255));
  world.rowRange(0, height / 2) = 0;
  const std::string png = encode_mask(world);
  mask_t mask{};
  mask.utime = utime_us;
  mask.stream = stream;
  mask.session = 7 + stream;
  mask.width = width, mask.height = height;
  mask.left_out = 0.5;
  mask.png.assign(png.begin(), png.end());
  mask.size = static_cast<int32_t>(png.size());
  return mask;
}

TEST_F(RuminatorNodeTest, TheImagesOfAWindowCarryWhatWasLearnedToBeNoWorldAlsoLater) {
  start();
  stream_ = 5;
  frames(20, 1);
  frames(5, kNoSubmap);
  bus_.publish(channels::kMask, learned_mask(5, now_, 80, 60));
  bus_.publish(channels::kMask, learned_mask(6, now_));
  mask_t broken = learned_mask(5, now_ + 1);
  broken.png.resize(20);
  broken.size = 20;
  bus_.publish(channels::kMask, broken);
  bus_.dispatch();
  frames(60, 2);
  ASSERT_EQ(jobs_.size(), 1U);
  ASSERT_EQ(jobs_[0].images.size(), 20U);
  for (const image_t& image : jobs_[0].images) {
    const cv::Mat pixels = decode_mask(metadata(image, kMaskKey)).value();
    ASSERT_EQ(pixels.size(), cv::Size(160, 120));
    EXPECT_EQ(cv::countNonZero(pixels.rowRange(0, 60)), 0);
    EXPECT_EQ(cv::countNonZero(pixels.rowRange(61, 120)), 160 * 59);
  }
  EXPECT_THAT(node_->status().detail, HasSubstr("1 rejected"));
  const testing::TemporaryFolder folder;
  ASSERT_EQ(write_window_job(folder / "a.window", jobs_[0]).error_text(), "");
  const Result<WindowJobFile> read = read_window_job(folder / "a.window");
  ASSERT_TRUE(read) << read.error_text();
  EXPECT_EQ(metadata(read->job.images[0], kMaskKey), metadata(jobs_[0].images[0], kMaskKey));
}

TEST_F(RuminatorNodeTest, MemoryHoldsOnlyWhatMayBeNeeded) {
  start();
  frames(1000, 1);
  EXPECT_LE(node_->frames().size(), 56) << "the approach, and what may yet be withdrawn";
  frames(30, kNoSubmap);
  EXPECT_LE(node_->frames().size(), 56 + 30);
}

TEST_F(RuminatorNodeTest, RawImagesAreCompressedAndKeepTheirMetadata) {
  jpeg_ = false;
  start();
  for (int i = 0; i < 30; ++i) {
    next();
    image_t image = make_image(now_, false);
    set_metadata(&image, kCalibrationKey, "fx: 100");
    bus_.publish(channels::kCamera, image);
    send_track(now_, 1, false);
    bus_.dispatch();
  }
  int compressed = 0;
  const int64_t first = 1'000'000 + kPeriodUs;
  const image_t* kept = node_->frames().find({first});
  ASSERT_NE(kept, nullptr);
  EXPECT_EQ(kept->pixelformat, image_t::PIXEL_FORMAT_MJPEG);
  EXPECT_EQ(metadata(*kept, kCalibrationKey), "fx: 100");
  const cv::Mat pixels = decode_grey(*kept).value();
  ASSERT_FALSE(pixels.empty());
  const cv::Mat original = decode_grey(make_image(first, false)).value();
  EXPECT_LT(cv::norm(pixels, original, cv::NORM_L1) / static_cast<double>(pixels.total()), 8.0);
  for (int64_t t = first; t < now_; t += kPeriodUs)
    if (const image_t* image = node_->frames().find({t}))
      compressed += image->pixelformat == image_t::PIXEL_FORMAT_MJPEG;
  EXPECT_GE(compressed, 5);
}

TEST_F(RuminatorNodeTest, StatesMayComeBeforeImages) {
  start();
  for (int i = 0; i < 200; ++i) {
    next();
    const bool lost = i >= 80 && i < 100;
    send_track(now_, lost ? kNoSubmap : i < 80 ? 1 : 2, !lost && i % 5 == 0);
    bus_.dispatch();
    send_image(now_);
    bus_.dispatch();
    node_->tick(now_);
  }
  ASSERT_EQ(jobs_.size(), 1);
  EXPECT_EQ(jobs_[0].window.gap.size(), 20);
  expect_images_of(jobs_[0]);
}

TEST_F(RuminatorNodeTest, LostMessagesOfEitherKindAreLivedWith) {
  start();
  std::mt19937 random(3);
  for (int i = 0; i < 400; ++i) {
    next();
    const bool lost = i >= 180 && i < 240;
    if (random() % 10 != 0) send_image(now_);
    if (random() % 10 != 0) send_track(now_, lost ? kNoSubmap : i < 180 ? 1 : 2, !lost && i % 5 == 0);
    bus_.dispatch();
    node_->tick(now_);
    bus_.dispatch();
  }
  ASSERT_EQ(jobs_.size(), 1);
  EXPECT_GE(jobs_[0].window.gap.size(), 30);
  EXPECT_LT(jobs_[0].window.gap.size(), 60);
  expect_images_of(jobs_[0]);
  EXPECT_THAT(node_->status().detail, HasSubstr("states without image"));
}

TEST_F(RuminatorNodeTest, WithoutFrontTrackerMemoryStaysBounded) {
  start();
  for (int i = 0; i < 1000; ++i) {
    next();
    send_image(now_);
    bus_.dispatch();
  }
  EXPECT_LE(node_->frames().size(), 128);
  EXPECT_GT(node_->frames().dropped(), 0);
}

TEST_F(RuminatorNodeTest, BytesAreBounded) {
  options_.ring_mb = 1;  // room for about 70 images
  start();
  for (int loss = 0; loss < 5; ++loss) {
    frames(60, 2 * loss + 1, 4);
    frames(20, kNoSubmap);
    EXPECT_LE(node_->frames().bytes(), 1'000'000);
  }
  frames(60, 99, 4);
  ASSERT_EQ(jobs_.size(), 5);
  for (const WindowJob& job : jobs_) expect_images_of(job);
  frames(800, kNoSubmap);  // a gap that needs far more memory
  EXPECT_LE(node_->frames().bytes(), 1'000'000);
  node_->finish();
  ASSERT_FALSE(jobs_.empty());
  EXPECT_GT(jobs_.back().window.gap.size(), 20);
  expect_images_of(jobs_.back());
}

TEST_F(RuminatorNodeTest, AStillGapIsThinned) {
  options_.window.gap_max_frames = 20;
  start();
  frames(50, 1);
  const cv::Mat still = [] {
    cv::Mat grey(120, 160, CV_8U);
    cv::RNG(1).fill(grey, cv::RNG::UNIFORM, 0, 255);
    cv::GaussianBlur(grey, grey, {}, 3);
    cv::normalize(grey, grey, 0, 255, cv::NORM_MINMAX);
    return grey;
  }();
  for (int i = 0; i < 100; ++i) {
    next();
    bus_.publish(channels::kCamera, make_jpeg_image(now_, still));
    send_track(now_, kNoSubmap, false);
    bus_.dispatch();
  }
  frames(60, 2);
  ASSERT_EQ(jobs_.size(), 1);
  EXPECT_EQ(jobs_[0].window.gap_frames, 100);
  EXPECT_EQ(jobs_[0].window.gap.size(), 20);
  EXPECT_EQ(jobs_[0].window.gap.back().utime_us, jobs_[0].window.lost_utime_us + 19 * kPeriodUs)
      << "others did not move";
  expect_images_of(jobs_[0]);
}

TEST_F(RuminatorNodeTest, AStartThatGetsAllItsPosesIsNotAnnounced) {
  start();
  frames(45, kNoSubmap);
  for (int i = 1; i <= 45; ++i) send_track(1'000'000 + i * kPeriodUs, 1, i % 9 == 0);
  frames(100, 1);
  EXPECT_TRUE(announced_.empty());
  EXPECT_FALSE(node_->status().degraded);
  frames(10, kNoSubmap);
  ASSERT_FALSE(announced_.empty());
  EXPECT_EQ(announced_[0].window_id, 1);
}

TEST_F(RuminatorNodeTest, FramesPosedAfterwardsBecomeDepartureWithTheirImages) {
  start();
  frames(100, 1);
  frames(60, kNoSubmap);
  const int64_t resumes = now_ + kPeriodUs;
  for (int i = 20; i >= 1; --i) send_track(resumes - i * kPeriodUs, 2, i % 5 == 0);
  frames(60, 2);
  ASSERT_EQ(jobs_.size(), 1);
  const RuminationWindow& window = jobs_[0].window;
  EXPECT_EQ(window.gap_frames, 40);
  EXPECT_EQ(window.resumed_utime_us, resumes - 20 * kPeriodUs);
  EXPECT_EQ(window.departure.front().utime_us, window.resumed_utime_us);
  EXPECT_THAT(node_->status().detail, HasSubstr("0 states without image"));
  expect_images_of(jobs_[0]);
}

TEST_F(RuminatorNodeTest, FinishEndsTheOpenWindow) {
  start();
  frames(50, 1);
  frames(10, kNoSubmap);
  node_->finish();
  bus_.dispatch();
  ASSERT_EQ(announced_.back().state, window_t::QUEUED);
  EXPECT_THAT(announced_.back().reason, HasSubstr("ended while tracking was lost"));
  EXPECT_EQ(announced_.back().resumed_utime, 0);
  expect_images_of(jobs_.at(0));
}

TEST_F(RuminatorNodeTest, ImagesAreRebuiltAgainAsAWindowByPlace) {
  start();
  frames(30, 1);
  frames(10, kNoSubmap);
  frames(30, 2);
  node_->finish();
  ASSERT_EQ(jobs_.size(), 1u);
  std::vector<Sample> samples;
  std::vector<image_t> images;
  for (int64_t utime_us = now_ - 20 * kPeriodUs; utime_us <= now_; utime_us += 2 * kPeriodUs) {
    samples.push_back({.utime_us = utime_us});
    images.push_back(make_image(utime_us));
  }
  node_->rebuild_again(samples, images);
  bus_.dispatch();
  ASSERT_EQ(jobs_.size(), 2u);
  const RuminationWindow &by_time = jobs_[0].window, &again = jobs_[1].window;
  EXPECT_FALSE(by_time.by_place);
  EXPECT_TRUE(again.by_place);
  EXPECT_EQ(again.id, by_time.id + 1);
  EXPECT_EQ(again.session, by_time.session);
  EXPECT_EQ(again.gap.size(), samples.size());
  EXPECT_EQ(again.samples().size(), samples.size());
  expect_images_of(jobs_[1]);
  EXPECT_EQ(describe(again), "11 images that look alike");
  ASSERT_FALSE(announced_.empty());
  EXPECT_NE(announced_.back().by_place, 0);
}

TEST_F(RuminatorNodeTest, NonsenseIsCountedAndHurtsNothing) {
  start();
  std::mt19937 random(1);
  for (int i = 0; i < 2000; ++i) {
    std::vector<uint8_t> bytes(random() % 300);
    for (uint8_t& byte : bytes) byte = static_cast<uint8_t>(random());
    bus_.publish_raw(channels::kCamera, bytes);
    bus_.publish_raw(channels::kTrack, bytes);
  }
  image_t broken = make_image(5, false);
  broken.width = -3;
  bus_.publish(channels::kCamera, broken);
  image_t liar = make_image(6, false);  // its height is not that of its data
  liar.height = 100000;
  bus_.publish(channels::kCamera, liar);
  track_t poseless{};  // its quaternion is zero
  poseless.utime = 7;
  poseless.state = track_t::TRACKING;
  poseless.submap_id = 1;
  bus_.publish(channels::kTrack, poseless);
  send_track(6, 1, true);
  frames(30, 1);
  EXPECT_THAT(node_->status().detail, HasSubstr("1 rejected"));
  EXPECT_EQ(node_->frames().broken(), 2);
  EXPECT_EQ(node_->frames().find({6}), nullptr);
  frames(5, kNoSubmap);
  frames(60, 2);
  EXPECT_EQ(jobs_.size(), 1);
}

TEST_F(RuminatorNodeTest, DamagedMessagesAreSurvived) {
  options_.ring_mb = 2;
  start();
  std::mt19937 random(1);
  const auto damaged = [&random](std::vector<uint8_t> bytes) {
    for (size_t i = 0; i < 1 + random() % 4; ++i) bytes[8 + random() % 40] = static_cast<uint8_t>(random());
    if (random() % 4 == 0) bytes.resize(random() % bytes.size());
    return bytes;
  };
  track_t track{};
  track.state = track_t::TRACKING;
  track.cam_from_submap = to_wire(SE3());
  for (int i = 0; i < 5000; ++i) {
    next();
    track.utime = now_;
    track.submap_id = i / 50;
    track.is_keyframe = i % 3 == 0;
    bus_.publish_raw(channels::kCamera, damaged(encode_message(make_image(now_, i % 2 == 0))));
    bus_.publish_raw(channels::kTrack, damaged(encode_message(track)));
    bus_.dispatch();
    node_->tick(now_);
    ASSERT_LE(node_->frames().bytes(), 2'000'000);
  }
  EXPECT_LE(jobs_.size(), 16);
}

TEST_F(RuminatorNodeTest, TheSameInputGivesTheSameAnnouncements) {
  std::vector<std::vector<uint8_t>> runs[2];
  for (auto& run : runs) {
    MemoryBus bus;
    RuminatorNode node(bus, options_, {});
    bus.subscribe<window_t>(channels::kWindow, {}, [&run](const window_t& w) { run.push_back(encode_message(w)); });
    for (int i = 1; i < 200; ++i) {
      const int64_t utime = i * kPeriodUs;
      bus.set_now_us(utime);
      bus.publish(channels::kCamera, make_image(utime));
      bus.dispatch();
      track_t track{};
      track.utime = utime;
      track.session = 1;
      track.state = track_t::TRACKING;
      track.submap_id = i % 50 < 20 ? kNoSubmap : i / 50 + 1;
      track.cam_from_submap = to_wire(SE3());
      track.is_keyframe = i % 3 == 0;
      bus.publish(channels::kTrack, track);
      bus.dispatch();
      node.tick(utime);
      bus.dispatch();
    }
    node.finish();
    bus.dispatch();
  }
  EXPECT_FALSE(runs[0].empty());
  EXPECT_EQ(runs[0], runs[1]);
}

}  // namespace
}  // namespace rumi::ruminator
