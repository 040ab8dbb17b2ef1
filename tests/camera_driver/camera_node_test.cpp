// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/camera_node.h"

#include <gmock/gmock.h>

#include "bus/transport/log_file.h"
#include "bus/transport/memory_bus.h"
#include "bus/wire/image_codec.h"
#include "camera_driver/open_source.h"
#include "rumi/recordings/export_recording.h"
#include "rumi/recordings/import_log.h"
#include "tests/formats/recording.h"

namespace rumi::camera_driver {
namespace {

using namespace testing;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class CameraNodeTest : public ::testing::Test {
 protected:
  CameraNodeTest() {
    write_tum(folder_.path(), 5);
    bus_.subscribe<image_t>(channels::kCamera, {}, [this](const image_t& image) { images_.push_back(image); });
  }
  // Returns how many images have come in all when the clock is at now_us.
  size_t tick(CameraNode& node, int64_t now_us) {
    bus_.set_now_us(now_us);
    node.tick(now_us);
    bus_.dispatch();
    return images_.size();
  }
  TemporaryFolder folder_;
  MemoryBus bus_;
  CameraOptions options_;
  std::vector<image_t> images_;
};

TEST_F(CameraNodeTest, KeepsTheRecordedPace) {
  CameraNode node(bus_, folder_.path().string(), options_);
  EXPECT_EQ(tick(node, 7'000'000), 1u);  // the first at once
  EXPECT_EQ(node.next_tick_us(7'090'000), 7'100'000);
  EXPECT_EQ(tick(node, 7'099'999), 1u);
  EXPECT_EQ(tick(node, 7'100'000), 2u);
  EXPECT_FALSE(node.done());
  EXPECT_EQ(tick(node, 9'000'000), 5u);  // late: nothing is left out
  EXPECT_TRUE(node.done());
  EXPECT_EQ(images_[1].utime, 1000100000);
  EXPECT_EQ(metadata(images_[1], kPublishedKey), "7100000");
  EXPECT_EQ(node.status().last_utime_us, 1000400000);
  EXPECT_THAT(node.status().detail, HasSubstr("5 of 5 images"));
}

TEST_F(CameraNodeTest, ComplainsWhereImagesWereLeftOut) {
  CameraNode whole(bus_, folder_.path().string(), options_);
  tick(whole, 7'000'000);
  EXPECT_THAT(whole.complaints(), IsEmpty());
  tick(whole, 9'000'000);
  whole.stop();
  EXPECT_THAT(whole.complaints(), IsEmpty());
  write_file(folder_ / "rgb/2.png", "no image");
  CameraNode node(bus_, folder_.path().string(), options_);
  tick(node, 7'000'000);
  EXPECT_THAT(node.complaints(), IsEmpty()) << "not at its end";
  tick(node, 9'000'000);
  ASSERT_TRUE(node.done());
  EXPECT_THAT(node.complaints(), ElementsAre(HasSubstr("1 of 5 images (20 %) were left out")));
}

TEST_F(CameraNodeTest, SaysThatItWasEndedInTheMiddle) {
  CameraNode node(bus_, folder_.path().string(), options_);
  tick(node, 7'000'000);
  tick(node, 7'100'000);
  node.stop();
  EXPECT_THAT(node.complaints(), ElementsAre(HasSubstr(" ended after 2 of 5 images, as somebody asked it to")));
}

TEST_F(CameraNodeTest, SpeedAndLiveStamps) {
  options_.speed = 2;
  options_.live_stamps = true;
  CameraNode node(bus_, folder_.path().string(), options_);
  tick(node, 7'000'000);
  EXPECT_EQ(tick(node, 7'050'000), 2u);
  EXPECT_EQ(tick(node, 7'040'000), 2u);  // the clock was set back
  EXPECT_EQ(tick(node, 7'150'000), 4u);
  std::vector<int64_t> times;
  for (const image_t& image : images_) times.push_back(image.utime);
  EXPECT_THAT(times, ElementsAre(7'000'000, 7'050'000, 7'150'000, 7'150'001));
}

TEST_F(CameraNodeTest, ReplayIsNotPacedAndSaysNothingOfTheClock) {
  CameraNode node(bus_, folder_.path().string(), options_);
  std::vector<int64_t> times;
  while (const std::optional<int64_t> utime_us = node.next_utime_us()) {
    times.push_back(*utime_us);
    bus_.set_now_us(*utime_us);
    node.publish_next();
    node.tick(*utime_us + 1'000'000);
    bus_.dispatch();
  }
  EXPECT_TRUE(node.done());
  EXPECT_EQ(times.size(), 5u);
  ASSERT_EQ(images_.size(), 5u);
  for (size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(images_[i].utime, times[i]);
    EXPECT_EQ(metadata(images_[i], kPublishedKey), "");
  }
}

TEST_F(CameraNodeTest, AnInputThatCannotBeUsedThrowsItsReason) {
  EXPECT_THROW(CameraNode(bus_, "/nowhere", options_), std::runtime_error);
}

std::vector<image_t> all_images(const fs::path& input) {
  const OpenedSource opened = open_image_source(input.string(), {});
  EXPECT_EQ(opened.error_text(), "");
  std::vector<image_t> images;
  while (opened.has_value()) {
    std::optional<image_t> image = (*opened)->next();
    if (!image) break;
    images.push_back(std::move(*image));
  }
  return images;
}

TEST(LogConversion, ThereAndBackIsTheSame) {
  for (const char* extension : {".jpg", ".png"}) {
    const TemporaryFolder folder;
    write_tum(folder / "data", 4, extension);
    const std::string log = folder / "x.lcm";
    ASSERT_EQ(tool::run_export({folder / "data", log, "CAMERA", {}, {}}), 0);
    ASSERT_EQ(tool::run_import({log, folder / "back", {}}), 0);
    const std::vector<image_t> first = all_images(folder / "data"), in_log = all_images(log),
                               back = all_images(folder / "back");
    ASSERT_EQ(first.size(), 4u);
    ASSERT_EQ(in_log.size(), 4u);
    ASSERT_EQ(back.size(), 4u);
    for (size_t i = 0; i < 4; ++i) {
      EXPECT_EQ(encode_message(in_log[i]), encode_message(first[i]));
      EXPECT_EQ(encode_message(back[i]), encode_message(first[i]));
    }
    LogReader reader(log);
    EXPECT_EQ(reader.next()->utime_us, 1000000000);
  }
}

TEST(LogConversion, BadInputAndOutput) {
  const TemporaryFolder folder;
  write_tum(folder / "data", 2);
  const std::string data = folder / "data", log = folder / "x.lcm";
  EXPECT_EQ(tool::run_export({folder / "missing", log, "CAMERA", {}, {}}), 1);
  EXPECT_FALSE(fs::exists(log));
  EXPECT_EQ(tool::run_export({data, folder / "no/such/folder.lcm", "CAMERA", {}, {}}), 1);
  ASSERT_EQ(tool::run_export({data, log, "CAMERA", {}, {}}), 0);
  const std::string bytes = read_file(log);
  EXPECT_EQ(tool::run_export({data, log, "CAMERA", {}, {}}), 1);  // a file is never replaced
  EXPECT_EQ(read_file(log), bytes);
  EXPECT_EQ(tool::run_import({log, data, {}}), 1);  // the folder is not empty
  EXPECT_EQ(tool::run_import({data + "/rgb.txt", folder / "out", {}}), 1);
  EXPECT_FALSE(fs::exists(folder / "out"));
  CameraOptions other;
  other.log_channel = "OTHER";
  EXPECT_THAT(open_image_source(log, other).error_text(), HasSubstr("log_channel"));
  write_file(log, bytes.substr(0, bytes.size() - 100));  // cut off: images that are whole can be read
  EXPECT_EQ(all_images(log).size(), 1u);
}

}  // namespace
}  // namespace rumi::camera_driver
