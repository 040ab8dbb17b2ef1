// SPDX-License-Identifier: BSD-3-Clause
// Which images are of one session: streams, cameras and recordings that come one after the other, or at once.
#include <gmock/gmock.h>

#include "bus/wire/image_stream.h"
#include "tests/front_tracker/front_tracker_node_fixture.h"

namespace rumi::front_tracker {
namespace {

using testing::FrontTrackerNodeTest;

TEST_F(FrontTrackerNodeTest, AnImageThatCannotBeUsedBeginsNoSession) {
  const cv::Mat large(480, 640, CV_8U, cv::Scalar(9));
  give(image(1000, large));  // calibrated for another size, until somebody puts that right
  EXPECT_FALSE(node_->tracker());
  camera_ = tool::default_synth_camera(640, 480);
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
  for (const int64_t stream : {5, 6}) {  // of the same times, as folders of images are
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

TEST_F(FrontTrackerNodeTest, SessionsBeginAfterThoseOfTheMapThatTheyComeInto) {
  node_->begin_sessions_after(9'000'000'000);
  give(image(1000, grey_));
  EXPECT_EQ(tracks_.front().session, 9'000'000'001);
}

}  // namespace
}  // namespace rumi::front_tracker
