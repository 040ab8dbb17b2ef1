// SPDX-License-Identifier: BSD-3-Clause
// Tests which images belong to one session: streams, cameras and recordings, one after the other or mixed.
#include <gmock/gmock.h>

#include <functional>

#include "bus/wire/image_stream.h"
#include "tests/front_tracker/front_tracker_node_fixture.h"
#include "tests/support/captured_log.h"
#include "tests/support/count_of.h"

namespace rumi::front_tracker {
namespace {

using testing::FrontTrackerNodeTest;
using ::testing::HasSubstr;
using testing::node_options;

TEST_F(FrontTrackerNodeTest, AnImageThatCannotBeUsedBeginsNoSession) {
  const cv::Mat large(480, 640, CV_8U, cv::Scalar(9));
  give(image(1000, large));  // calibrated for another size
  EXPECT_FALSE(node_->tracker());
  camera_ = synth::default_synth_camera(640, 480);
  give(image(2000, large));
  ASSERT_EQ(tracks_.size(), 1u);
  EXPECT_EQ(node_->tracker()->camera().width, 640);
}

TEST_F(FrontTrackerNodeTest, OldImagesAreRefusedAndARestartedRecordingIsANewSession) {
  for (int i = 0; i < 20; ++i) give(image(1'000'000 + 1000 * i, grey_));
  ASSERT_EQ(tracks_.size(), 20u);
  give(image(1'005'000, grey_));
  EXPECT_EQ(tracks_.size(), 20u) << "one image out of order";
  give(image(1'030'000, grey_));
  ASSERT_EQ(tracks_.size(), 21u);
  for (int i = 0; i < 20; ++i) give(image(5000 + 1000 * i, grey_));
  EXPECT_GT(tracks_.back().session, tracks_.front().session);
  EXPECT_EQ(tracks_.back().utime, 24'000);
  EXPECT_EQ(tracks_.size(), 21u + 20u) << "the images that waited for the decision are the first of the session";
  for (size_t i = 1; i < tracks_.size(); ++i)
    EXPECT_EQ(tracks_[i].sequence, tracks_[i].session == tracks_[i - 1].session ? tracks_[i - 1].sequence + 1 : 0);
}

TEST_F(FrontTrackerNodeTest, ASecondCameraOnTheChannelIsToldAndKeptApart) {
  const Camera own = camera_;
  const auto other_camera = [&] { camera_.fx = own.fx * 1.1; };
  for (int i = 0; i < 40; ++i) {
    camera_ = own;
    if (i % 2 == 1) other_camera();
    give(image(1'000'000 + 1000 * i, grey_));
  }
  ASSERT_EQ(tracks_.size(), 20u);
  for (const track_t& track : tracks_) EXPECT_EQ(track.utime / 1000 % 2, 0) << "one of the second camera";
  EXPECT_EQ(tracks_.back().session, tracks_.front().session);
  const std::string detail = node_->status().detail;
  EXPECT_NE(detail.find("20 images refused: another camera"), std::string::npos) << detail;
}

TEST_F(FrontTrackerNodeTest, ACameraThatIsChangedBeginsANewSession) {
  for (int i = 0; i < 5; ++i) give(image(1'000'000 + 1000 * i, grey_));
  camera_.fx *= 1.1;
  for (int i = 5; i < 30; ++i) give(image(1'000'000 + 1000 * i, grey_));
  ASSERT_EQ(tracks_.size(), 30u);
  EXPECT_NE(tracks_.back().session, tracks_.front().session);
  EXPECT_EQ(node_->tracker()->camera().fx, camera_.fx);
}

TEST_F(FrontTrackerNodeTest, ASecondStreamOfTheSameCalibrationIsToldAndKeptApart) {
  for (int i = 0; i < 40; ++i) {
    image_t message = image(1'000'000 + 1000 * i, grey_);
    set_stream(i % 2 == 0 ? 5 : 6, &message);
    give(message);
  }
  ASSERT_EQ(tracks_.size(), 20u);
  for (const track_t& track : tracks_) EXPECT_TRUE(track.utime / 1000 % 2 == 0 && track.stream == 5);
  const std::string detail = node_->status().detail;
  EXPECT_NE(detail.find("20 images refused: another camera"), std::string::npos) << detail;
}

TEST_F(FrontTrackerNodeTest, AnotherRecordingIsAnotherSessionWhateverItsTimes) {
  for (const int64_t stream : {5, 6}) {  // with the same times, as in folders of images
    for (int i = 0; i < 30; ++i) {
      image_t message = image(1000 * i, grey_);
      set_stream(stream, &message);
      give(message);
    }
  }
  EXPECT_EQ(tracks_.front().stream, 5);
  EXPECT_EQ(tracks_.back().stream, 6);
  EXPECT_GT(tracks_.back().session, tracks_.front().session);
  EXPECT_EQ(tracks_.size(), 60u);
}

TEST_F(FrontTrackerNodeTest, ImagesWithoutANameAreOfTheirSessionsStream) {
  for (int i = 0; i < 20; ++i) give(image(1'000'000 + 1000 * i, grey_));
  for (int i = 0; i < 20; ++i) give(image(1000 * i, grey_));
  EXPECT_EQ(tracks_.front().stream, tracks_.front().session);
  EXPECT_EQ(tracks_.back().stream, tracks_.back().session);
  EXPECT_NE(tracks_.back().stream, tracks_.front().stream);
}

class NodeOnTheClock : public FrontTrackerNodeTest {
 protected:
  // Publishes an image every 1/30 s by the computer's clock, whatever the time of the image.
  void come(int64_t utime_us) {
    bus_.set_now_us(now_us_ += kPeriod_us);
    bus_.publish(channels::kCamera, image(utime_us, grey_));
    bus_.dispatch();
    tick();
  }
  void expect_nothing_begins(const std::function<int64_t(int64_t now_us)>& utime_us, const std::string& what) {
    const testing::CapturedLog log;
    for (int i = 0; i < 90; ++i) come(utime_us(now_us_));
    node_->finish();
    EXPECT_TRUE(tracks_.empty());
    EXPECT_FALSE(node_->tracker());
    EXPECT_EQ(testing::count_of(log.text(), "utime must be microseconds since 1970"), 1u) << log.text();
    EXPECT_THAT(log.text(), HasSubstr(what));
    EXPECT_EQ(node_->refused().of(RefusedImages::Kind::kNoTime), 90);
  }
  static constexpr int64_t kPeriod_us = 33'333;
  int64_t now_us_ = 1'700'000'000'000'000;
};

TEST_F(NodeOnTheClock, TimesThatStandBeginNoSessionAndAreToldOnce) {
  expect_nothing_begins([](int64_t) { return 0; }, "the times of the images stand (0): ");
}

TEST_F(NodeOnTheClock, SecondsBeginNoSessionAndAreToldOnce) {
  expect_nothing_begins([](int64_t now_us) { return now_us / 1'000'000; }, "as seconds do");
}

TEST_F(NodeOnTheClock, MillisecondsBeginNoSessionAndAreToldOnce) {
  expect_nothing_begins([](int64_t now_us) { return now_us / 1000; }, " us in 33.3 ms, as milliseconds do");
}

TEST_F(NodeOnTheClock, WhatBeginsFarFromTheClockLosesNoImage) {
  for (int i = 0; i < 30; ++i) come(kPeriod_us * i);
  EXPECT_EQ(tracks_.size(), 30u);
  EXPECT_EQ(tracks_.front().utime, 0);
  EXPECT_EQ(node_->refused().total(), 0);
  EXPECT_EQ(tracks_.back().session, tracks_.front().session);
}

TEST_F(NodeOnTheClock, OneTimeInTwentyAnHourAheadIsLeftOutAndComplainedOf) {
  for (int i = 1; i <= 60; ++i) come(now_us_ + (i % 20 == 0 ? 3'600'000'000 : 0));
  node_->finish();
  EXPECT_EQ(tracks_.size(), 57u);
  EXPECT_EQ(tracks_.back().session, tracks_.front().session);
  EXPECT_THAT(node_->complaints(), ::testing::Contains(HasSubstr("3 of 60 images refused: of a time far ahead")));
}

TEST_F(NodeOnTheClock, AClockThatIsSetForwardLosesNoImage) {
  for (int i = 0; i < 20; ++i) come(now_us_);
  for (int i = 0; i < 20; ++i) come(now_us_ + 3'600'000'000);
  EXPECT_EQ(tracks_.size(), 40u);
  EXPECT_EQ(node_->refused().total(), 0);
}

TEST_F(NodeOnTheClock, DoubledAndLateOnesAreComplainedOf) {
  for (int i = 1; i <= 40; ++i) {
    come(now_us_ - (i % 10 == 0 ? 70'000 : 0));
    come(now_us_ - kPeriod_us);
  }
  EXPECT_EQ(tracks_.size(), 40u);
  EXPECT_THAT(node_->complaints(), ::testing::Contains(HasSubstr("36 of 80 images refused: doubled")));
  EXPECT_THAT(node_->complaints(), ::testing::Contains(HasSubstr("4 of 80 images refused: out of order")));
}

TEST_F(FrontTrackerNodeTest, SessionsBeginAfterThoseOfTheMapThatTheyComeInto) {
  node_->begin_sessions_after(9'000'000'000);
  give(image(1000, grey_));
  EXPECT_EQ(tracks_.front().session, 9'000'000'001);
}

}  // namespace
}  // namespace rumi::front_tracker
