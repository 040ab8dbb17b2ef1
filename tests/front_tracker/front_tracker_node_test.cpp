// SPDX-License-Identifier: BSD-3-Clause
#include "front_tracker/front_tracker_node.h"

#include <gmock/gmock.h>

#include <random>

#include "bus/wire/image_codec.h"
#include "lcmtypes/rumi/map_request_t.hpp"
#include "tests/front_tracker/front_tracker_node_fixture.h"
#include "tests/support/captured_log.h"

namespace rumi::front_tracker {
namespace {

using ::testing::ElementsAre;
using testing::FrontTrackerNodeTest;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::node_options;

TEST_F(FrontTrackerNodeTest, AnImageWithoutCalibrationSaysWhatToDo) {
  give(image(1000, grey_, false));
  EXPECT_TRUE(tracks_.empty());
  const NodeStatus status = node_->status();
  EXPECT_TRUE(status.degraded);
  EXPECT_NE(status.detail.find("--camera FILE"), std::string::npos) << status.detail;
  give(image(2000, grey_));
  EXPECT_EQ(tracks_.size(), 1u) << "it goes on as soon as there is one";
  EXPECT_FALSE(node_->status().degraded);
}

TEST_F(FrontTrackerNodeTest, SaysOnceThatNoImageComes) {
  MemoryBus bus;  // a bus of its own
  bus.set_now_us(1'000'000);
  FrontTrackerNode node(bus, node_options());
  const testing::CapturedLog log;
  node.tick(10'900'000);
  EXPECT_EQ(log.text(), "");
  node.tick(11'000'000);
  EXPECT_THAT(log.text(), HasSubstr("no image has come for 10 s"));
  const std::string once = log.text();
  node.tick(60'000'000);
  EXPECT_EQ(log.text(), once);
}

TEST_F(FrontTrackerNodeTest, SaysThatWhatComesOnTheCamerasChannelIsNoImageOrHasNoTime) {
  MemoryBus bus;  // a bus of its own
  bus.set_now_us(1'000'000);
  FrontTrackerNode node(bus, node_options());
  const testing::CapturedLog log;
  bus.publish(channels::kCamera, map_request_t());
  bus.publish(channels::kCamera, image(1'700'000'000'000'000'000, grey_));  // in nanoseconds
  bus.publish(channels::kCamera, image(-5, grey_));
  bus.dispatch();
  EXPECT_THAT(log.text(), HasSubstr("it is no message of the type image_t"));
  EXPECT_THAT(log.text(),
              HasSubstr("its utime is 1700000000000000000, as nanoseconds would be: it must be microseconds"));
  EXPECT_THAT(node.complaints(), ElementsAre(HasSubstr("1 of 3 images refused: no messages of the type image_t"),
                                             HasSubstr("2 of 3 images refused: without a time")));
  EXPECT_EQ(node.status().refused_images, 0) << "the bus counts them as undecodable";
}

TEST_F(FrontTrackerNodeTest, ImagesOfWhichNoneGetsAPoseAreNotAll) {
  EXPECT_THAT(node_->complaints(), IsEmpty()) << "nothing came";
  give(image(1000, grey_));
  EXPECT_THAT(node_->complaints(), ElementsAre(HasSubstr("none of 1 images got a pose")));
}

TEST_F(FrontTrackerNodeTest, ImagesOfAnotherSizeAreRefusedByNameOfBothSizes) {
  give(image(1000, cv::Mat(480, 640, CV_8U, cv::Scalar(9))));
  EXPECT_NE(node_->status().detail.find("640x480"), std::string::npos);
  EXPECT_NE(node_->status().detail.find("320x240"), std::string::npos);
  give(image(2000, grey_));
  give(image(3000, cv::Mat(100, 100, CV_8U, cv::Scalar(9))));
  give(image(4000, grey_));
  ASSERT_EQ(tracks_.size(), 2u);
  EXPECT_EQ(tracks_[0].utime, 2000);
  EXPECT_EQ(tracks_[1].utime, 4000);
}

TEST_F(FrontTrackerNodeTest, DamagedImagesAreCountedAndPassedOver) {
  give(image(1000, grey_));
  image_t damaged = image(2000, grey_);
  damaged.data.resize(damaged.data.size() / 2);
  damaged.size = static_cast<int32_t>(damaged.data.size());
  give(damaged);
  image_t lying = make_grey_image(3000, grey_);
  lying.width = 100000;
  give(lying);
  give(image(4000, grey_));
  EXPECT_EQ(tracks_.size(), 2u);
  const NodeStatus status = node_->status();
  EXPECT_THAT(status.detail, HasSubstr("1 images refused: size, 1 images refused: damaged"));
  EXPECT_EQ(status.refused_images, 2);
  EXPECT_TRUE(status.degraded) << "since the last status";
  EXPECT_FALSE(node_->status().degraded);
  EXPECT_THAT(node_->complaints(),
              ElementsAre(HasSubstr("1 of 4 images refused: not of the calibration's size (the first: it "
                                    "is 100000x240 but"),
                          HasSubstr("1 of 4 images refused: damaged, or of a format that is not read (the "
                                    "first: corrupt JPEG"),
                          HasSubstr("none of 2 images got a pose")));
}

TEST_F(FrontTrackerNodeTest, LargeImagesAreWorkedOnSmaller) {
  MemoryBus bus;
  FrontTrackerOptions options;
  options.mapping_thread = false;
  options.max_image_side = 160;
  FrontTrackerNode node(bus, options);
  bus.publish(channels::kCamera, image(1000, grey_));
  bus.dispatch();
  ASSERT_TRUE(node.tracker());
  EXPECT_EQ(node.tracker()->camera().width, 160);
  EXPECT_EQ(node.tracker()->camera().height, 120);
  EXPECT_FALSE(node.status().degraded) << node.status().detail;
}

TEST_F(FrontTrackerNodeTest, BadCalibrationNamesFieldAndValue) {
  camera_.fx = std::numeric_limits<double>::quiet_NaN();
  give(image(1000, grey_));
  EXPECT_TRUE(tracks_.empty());
  EXPECT_NE(node_->status().detail.find("fx"), std::string::npos) << node_->status().detail;
}

TEST_F(FrontTrackerNodeTest, GarbageOnItsChannelsDoesNoHarm) {
  give(image(1000, grey_));
  std::mt19937 rng(9);
  const std::vector<uint8_t> real = encode_message(image(2000, grey_));
  for (int i = 0; i < 10'000; ++i) {
    std::vector<uint8_t> bytes;
    if (i % 3 == 0) {
      bytes.resize(rng() % 300);
      for (uint8_t& b : bytes) b = static_cast<uint8_t>(rng());
    } else {
      bytes = real;
      if (i % 3 == 1) bytes.resize(rng() % bytes.size());
      for (int k = 0; k < 5 && !bytes.empty(); ++k)
        bytes[rng() % bytes.size()] ^= static_cast<uint8_t>(1u << rng() % 8);
    }
    bus_.publish_raw(i % 2 ? channels::kCamera : channels::kMapStatus, bytes);
    bus_.publish_raw(channels::kSubmapAck, bytes);
    bus_.dispatch();
  }
  const size_t before = tracks_.size();
  give(image(3000, grey_));
  EXPECT_EQ(tracks_.size(), before + 1) << "it works as before";
  EXPECT_FALSE(node_->status().detail.empty());
}

}  // namespace
}  // namespace rumi::front_tracker
