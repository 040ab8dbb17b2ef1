// SPDX-License-Identifier: BSD-3-Clause
// Tests the times of a recording's images: units, orders, clocks that were set back, parts that are played.
#include <gmock/gmock.h>

#include "bus/transport/bus.h"
#include "bus/transport/log_file.h"
#include "bus/wire/image_codec.h"
#include "bus/wire/image_stream.h"
#include "formats/camera/camera_file.h"
#include "tests/camera_driver/opened_source.h"

namespace rumi::camera_driver {
namespace {

using namespace testing;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(ImageSource, PlainFolderWithTimesAsNames) {
  const TemporaryFolder seconds, nanoseconds;
  for (const char* name : {"5.000001.png", "4.500000.png"}) cv::imwrite(seconds / name, picture(1));
  for (const char* name : {"1403636579763555584.png", "1403636579813555456.png"})
    cv::imwrite(nanoseconds / name, picture(1));
  CameraOptions options;
  options.camera_file = seconds / "calibration.yaml";
  write_file(options.camera_file, kCalibration);
  EXPECT_THAT(times(seconds.path(), options), ElementsAre(4500000, 5000001));
  EXPECT_THAT(times(nanoseconds.path(), options), ElementsAre(1403636579763556, 1403636579813555));
}

TEST(ImageSource, SelectionAndNewTimes) {
  const TemporaryFolder folder;
  write_tum(folder.path(), 10);
  CameraOptions options;
  options.every = 3, options.start_s = 0.2, options.duration_s = 0.6;
  EXPECT_THAT(times(folder.path(), options), ElementsAre(1000200000, 1000500000));
  EXPECT_EQ(open_image_source(folder.path().string(), options).value()->total(), 2);
  options.loop = true;
  EXPECT_THAT(times(folder.path(), options, 4), ElementsAre(1000200000, 1000500000, 1000800000, 1001100000));
  options.rate_hz = 4;
  EXPECT_THAT(times(folder.path(), options, 4), ElementsAre(1000200000, 1000450000, 1000700000, 1000950000));
  options = {};
  options.start_s = 5;
  EXPECT_THAT(error_of(folder.path(), options), AllOf(HasSubstr("lower --start"), HasSubstr("0.9 s long (10 images)")));
  options.start_s = std::nan("");
  EXPECT_THAT(error_of(folder.path(), options), HasSubstr("start is nan"));
}

TEST(ImageSource, IsPlayedAgainInColourForTheTimesThatAreAsked) {
  const TemporaryFolder folder;
  write_tum(folder.path(), 10);
  for (int i = 0; i < 10; ++i) cv::imwrite(folder / fmt::format("rgb/{}.png", i), picture(i, 64, 48, /*colour=*/true));
  CameraOptions options;
  options.every = 2;
  options.rate_hz = 20;
  const OpenedSource opened = open_recording(folder.path().string(), options);
  ASSERT_EQ(opened.error_text(), "");
  std::vector<int64_t> utimes;
  while (const std::optional<image_t> image = (*opened)->next()) utimes.push_back(image->utime);
  ASSERT_EQ(utimes.size(), 5u);
  const int64_t skipped = (*opened)->skipped().total();

  (*opened)->play_again({utimes[1], utimes[4], utimes[4] + 1}, ImageSource::Pixels::kColour);
  for (const size_t number : {1, 4}) {
    const std::optional<image_t> image = (*opened)->next();
    ASSERT_TRUE(image);
    EXPECT_EQ(image->utime, utimes[number]);
    const cv::Mat expected = picture(static_cast<int>(2 * number), 64, 48, /*colour=*/true);
    EXPECT_EQ(cv::norm(decode_bgr(*image).value(), expected), 0);
  }
  EXPECT_FALSE((*opened)->next());
  EXPECT_EQ((*opened)->skipped().total(), skipped);
}

TEST(ImageSource, ALoopOfNothingUsableEnds) {
  const TemporaryFolder folder;
  write_tum(folder.path(), 3);
  for (int i = 0; i < 3; ++i) write_file(folder.path() / fmt::format("rgb/{}.png", i), "no image");
  CameraOptions options;
  options.loop = true;
  EXPECT_THAT(error_of(folder.path(), options), HasSubstr("corrupt"));
}

TEST(ImageSource, ImagesOfNoTimeAreLeftOut) {
  const TemporaryFolder folder;
  const std::string log = folder / "x.lcm";
  {
    LogWriter writer(log);
    for (const int64_t utime_us : {INT64_MIN, int64_t{5}, INT64_MAX, int64_t{9}}) {
      image_t image = make_grey_image(utime_us, picture(1));
      set_metadata(&image, kCalibrationKey, kCalibration);
      writer.write(1, "CAMERA", encode_message(image));
    }
  }
  EXPECT_THAT(times(log), ElementsAre(5, 9));
}

TEST(ImageSource, TimesInAnotherUnitAreReadAsSuch) {
  const TemporaryFolder folder;
  write_tum(folder / "tum", 4);
  write_file(folder / "tum/rgb.txt",
             "1400000000000.0 rgb/0.png\n1400000000033.3 rgb/1.png\n1400000000066.7 rgb/2.png\n");
  EXPECT_THAT(times(folder / "tum"), ElementsAre(1400000000000000, 1400000000033300, 1400000000066700));
  write_file(folder / "tum/rgb.txt", "timestamp,filename\n5.0,rgb/0.png\n5.1,rgb/1.png\n");
  EXPECT_THAT(times(folder / "tum"), ElementsAre(5000000, 5100000));
  write_file(folder / "tum/rgb.txt", "5.0 rgb/0.png 5.01 depth/0.png\n5.1 rgb/1.png 5.11 depth/1.png\n");
  EXPECT_THAT(times(folder / "tum"), ElementsAre(5000000, 5100000));
}

TEST(ImageSource, NumbersOfImagesAreNoTimesAndARepeatedLineIsNoImage) {
  const TemporaryFolder folder;
  write_tum(folder.path(), 12);
  std::string list;
  for (int i = 0; i < 12; ++i) list += fmt::format("{} rgb/{}.png\n", i, i);
  write_file(folder / "rgb.txt", list);
  EXPECT_EQ(times(folder.path()).at(11), 1'100'000) << "at the calibration's fps";
  const std::string good = "5.0 rgb/0.png\n5.0 rgb/0.png\n5.1 rgb/1.png\n5.1 rgb/1.png\n";
  write_file(folder / "rgb.txt", good);
  const OpenedSource opened = open_image_source(folder.path().string(), {});
  EXPECT_THAT(times(**opened), ElementsAre(5000000, 5100000));
  EXPECT_EQ((*opened)->skipped().total(), 0);
}

// The list may be a binary file: a name of a megabyte must not be searched letter by letter for long.
TEST(ImageSource, ALineOfAMegabyteIsNoImage) {
  const TemporaryFolder folder;
  write_tum(folder.path(), 3);
  write_file(folder / "rgb.txt", read_file(folder / "rgb.txt") + "1001 rgb/" + std::string(1 << 20, 'x') + ".png\n");
  const OpenedSource opened = open_image_source(folder.path().string(), {});
  EXPECT_EQ(times(**opened).size(), 3u);
  EXPECT_EQ((*opened)->skipped().malformed, 1);
}

TEST(ImageSource, WithARateTimesNeedNotBeThere) {
  const TemporaryFolder folder;
  write_tum(folder.path(), 3);
  CameraOptions options;
  options.rate_hz = 10;
  for (const char* list :
       {"rgb/0.png\nrgb/1.png\nrgb/2.png\n", "-5.0 rgb/0.png\n-4.9 rgb/1.png\n-4.8 rgb/2.png\n",
        "monday rgb/0.png\ntuesday rgb/1.png\nwednesday rgb/2.png\n", "nan rgb/0.png\n1 rgb/1.png\n2 rgb/2.png\n"}) {
    write_file(folder / "rgb.txt", std::string("# list\n0.0 rgb/0.png\n") + list);
    const std::vector<int64_t> all = times(folder.path(), options);
    EXPECT_EQ(all.size(), 4u) << list;
    EXPECT_EQ(all.back() - all.front(), 300'000) << list;
    EXPECT_LT(times(folder.path()).size(), 4u) << list;
  }
}

TEST(ImageSource, ALogInAnotherUnitIsReadAsSuch) {
  const TemporaryFolder folder;
  for (const int64_t per_second : {1'000, 1'000'000'000}) {
    const std::string file = folder / fmt::format("{}.lcm", per_second);
    LogWriter log(file);
    for (int i = 0; i < 30; ++i) {
      image_t image = make_grey_image((1'400'000'000 * per_second) + i * per_second / 25, picture(i));
      set_metadata(&image, kCalibrationKey, kCalibration);
      log.write(i, "CAMERA", encode_message(image));
    }
    ASSERT_TRUE(log.close());
    const std::vector<int64_t> all = times(file);
    ASSERT_EQ(all.size(), 30u) << per_second;
    EXPECT_EQ(all.back(), 1'400'000'001'160'000) << per_second;
  }
}

TEST(ImageSource, AClockThatIsSetBackBeginsAnotherStream) {
  const TemporaryFolder folder;
  write_tum(folder.path(), 20);
  std::string list;
  for (int i = 0; i < 20; ++i) list += fmt::format("{} rgb/{}.png\n", (i < 10 ? 1000 : 500) + i, i);
  write_file(folder / "rgb.txt", list);
  const OpenedSource opened = open_image_source(folder.path().string(), {});
  ASSERT_EQ(opened.error_text(), "");
  std::vector<int64_t> streams, utimes;
  while (const std::optional<image_t> image = (*opened)->next()) {
    streams.push_back(rumi::stream_of(*image));
    utimes.push_back(image->utime);
  }
  ASSERT_EQ(utimes.size(), 20u);
  EXPECT_EQ(utimes[10], 510'000'000);
  EXPECT_EQ(streams[9], streams[0]);
  EXPECT_NE(streams[10], streams[9]);
  EXPECT_EQ(streams[19], streams[10]);
  CameraOptions options;
  options.start_s = 10.5;
  EXPECT_EQ(times(folder.path(), options).front(), 511'000'000) << "seconds of the recording, whatever its clock says";
  options = {};
  options.loop = true;
  const std::vector<int64_t> looped = times(folder.path(), options, 50);
  EXPECT_TRUE(std::is_sorted(looped.begin(), looped.end()));
}

TEST(ImageSource, TimesThatAreAllTheSameAskForARate) {
  const TemporaryFolder folder;
  write_tum(folder.path(), 3);
  write_file(folder / "rgb.txt", "0 rgb/0.png\n0 rgb/1.png\n0 rgb/2.png\n");
  EXPECT_THAT(error_of(folder.path()), AllOf(HasSubstr("3 images"), HasSubstr("--rate HZ")));
  CameraOptions options;
  options.rate_hz = 10;
  EXPECT_THAT(times(folder.path(), options), ElementsAre(0, 100000, 200000));
}

TEST(ImageSource, ImagesOfALogAreOrderedAndItsLengthIsKnown) {
  const TemporaryFolder folder;
  const std::string file = folder / "x.lcm";
  LogWriter log(file);
  for (const int64_t i : {0, 1, 3, 2, 4, 900, 5, 6, 7, 8}) {
    image_t image = make_grey_image(1'000'000 * (i + 1), picture(static_cast<int>(i)));
    set_metadata(&image, kCalibrationKey, kCalibration);
    log.write(1'000'000 * i, "CAMERA", encode_message(image));
  }
  ASSERT_TRUE(log.close());
  const OpenedSource opened = open_image_source(file, {});
  EXPECT_EQ((*opened)->total(), 9);
  EXPECT_EQ((*opened)->skipped().out_of_order, 1);
  for (int i = 0; i < 9; ++i) {
    const std::optional<image_t> image = (*opened)->next();
    EXPECT_EQ(image->utime, 1'000'000 * (i + 1));
    EXPECT_EQ(cv::norm(decode_grey(*image).value(), picture(i), cv::NORM_INF), 0) << i;
  }
}

}  // namespace
}  // namespace rumi::camera_driver
