// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/source/image_source.h"

#include <gmock/gmock.h>

#include <opencv2/videoio.hpp>

#include "bus/transport/bus.h"
#include "bus/transport/log_file.h"
#include "bus/wire/camera_file.h"
#include "bus/wire/image_codec.h"
#include "bus/wire/image_stream.h"
#include "camera_driver/open_source.h"
#include "tests/camera_driver/recording.h"

namespace rumi::camera_driver {
namespace {

using namespace testing;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<int64_t> times(ImageSource& source, size_t most = 1000) {
  std::vector<int64_t> all;
  while (all.size() < most) {
    const std::optional<image_t> image = source.next();
    if (!image) break;
    all.push_back(image->utime);
  }
  return all;
}

std::vector<int64_t> times(const fs::path& input, const CameraOptions& options = {}, size_t most = 1000) {
  const OpenedSource opened = open_image_source(input.string(), options);
  EXPECT_EQ(opened.error, "");
  return opened.ok() ? times(*opened.source, most) : std::vector<int64_t>();
}

std::string error_of(const fs::path& input, const CameraOptions& options = {}) {
  const OpenedSource opened = open_image_source(input.string(), options);
  EXPECT_FALSE(opened.ok());
  return opened.error;
}

TEST(ImageSource, TumFolder) {
  const TemporaryFolder folder;
  write_tum(folder.path(), 3);
  write(folder / "sub/rgb.txt", "#comment\r\n\r\n5.5\t../rgb/0.png\r\n6.000001 ../rgb/1.png\r\n");
  write(folder / "sub/calibration.yaml", kCalibration);
  EXPECT_THAT(times(folder.path()), ElementsAre(1000000000, 1000100000, 1000200000));
  EXPECT_THAT(times(folder / "sub/"), ElementsAre(5500000, 6000001));
}

TEST(ImageSource, ImagesCarryTheCalibration) {
  const TemporaryFolder folder;
  write_tum(folder.path(), 1);
  const OpenedSource opened = open_image_source(folder.path().string(), {});
  const std::optional<image_t> image = opened.source->next();
  EXPECT_EQ(metadata(*image, kCalibrationKey), camera_to_yaml(opened.source->camera()));
  EXPECT_EQ(opened.source->camera().fy, 51);
  EXPECT_EQ(opened.source->total(), 1);
}

int64_t stream_of(const fs::path& input, const CameraOptions& options = {}) {
  const OpenedSource opened = open_image_source(input.string(), options);
  EXPECT_EQ(opened.error, "");
  const std::optional<image_t> image = opened.source->next();
  const int64_t stream = rumi::stream_of(*image);
  while (const std::optional<image_t> later = opened.source->next()) EXPECT_EQ(rumi::stream_of(*later), stream);
  return stream;
}

TEST(ImageSource, ARecordingIsOneStreamWhereverItLiesAndWhicheverPartIsPlayed) {
  const TemporaryFolder folder;
  write_tum(folder / "a", 5);
  const int64_t stream = stream_of(folder / "a");
  EXPECT_NE(stream, kNoStream);
  fs::copy(folder / "a", folder / "b", fs::copy_options::recursive);
  EXPECT_EQ(stream_of(folder / "b"), stream);
  CameraOptions part;
  part.start_s = 0.2, part.every = 2;
  EXPECT_EQ(stream_of(folder / "a", part), stream);

  CameraOptions other_times;
  other_times.rate_hz = 5;
  EXPECT_NE(stream_of(folder / "a", other_times), stream);
  cv::imwrite(folder / "b/rgb/0.png", picture(99));
  EXPECT_NE(stream_of(folder / "b"), stream) << "the same times, and another first image";
  write_tum(folder / "c", 6);
  EXPECT_NE(stream_of(folder / "c"), stream) << "other times";
}

TEST(ImageSource, ALogKeepsTheStreamOfItsImages) {
  const TemporaryFolder folder;
  for (const bool is_named : {true, false}) {
    const std::string file = folder / fmt::format("{}.lcmlog", is_named);
    LogWriter log(file);
    for (int i = 0; i < 3; ++i) {
      image_t image = make_grey_image(1'000'000 * (i + 1), picture(i));
      if (is_named) set_stream(77, &image);
      log.write(image.utime, channels::kCamera, encode_message(image));
    }
    ASSERT_TRUE(log.close());
    write(folder / "calibration.yaml", kCalibration);
    if (is_named)
      EXPECT_EQ(stream_of(file), 77);
    else
      EXPECT_NE(stream_of(file), kNoStream);
  }
}

TEST(ImageSource, EurocFolderAtEveryDepth) {
  const TemporaryFolder folder;
  const fs::path cam0 = folder / "mav0/cam0";
  write(cam0 / "data.csv", "#timestamp [ns],filename\r\n1403636579763555584,a.png\r\n1403636579813555456,b.png\r\n");
  write(cam0 / "sensor.yaml",
        "rate_hz: 20\nresolution: [64, 48]\ncamera_model: pinhole\nintrinsics: [50, 51, 32, 24]\n"
        "distortion_model: radial-tangential\ndistortion_coefficients: [0.1, 0, 0, 0]\n");
  fs::create_directories(cam0 / "data");
  for (const char* name : {"a.png", "b.png"}) cv::imwrite((cam0 / "data" / name).string(), picture(1));
  for (const char* input : {"", "mav0", "mav0/cam0", "mav0/cam0/"})
    EXPECT_THAT(times(folder / input), ElementsAre(1403636579763556, 1403636579813555)) << input;
}

TEST(ImageSource, PlainFolder) {
  const TemporaryFolder folder;
  for (int i : {1, 2, 10}) cv::imwrite(folder / fmt::format("{}.png", i), picture(i));
  write(folder / "calibration.yaml", kCalibration);
  EXPECT_THAT(times(folder.path()), ElementsAre(0, 100000, 200000));  // fps of the calibration
  CameraOptions options;
  options.rate_hz = 30;
  EXPECT_THAT(times(folder.path(), options), ElementsAre(0, 33333, 66667));
  const OpenedSource opened = open_image_source(folder.path().string(), {});
  opened.source->next();
  std::string error;
  EXPECT_EQ(cv::norm(decode_grey(*opened.source->next(), &error), picture(2), cv::NORM_INF), 0);
  write(folder / "calibration.yaml", "fx: 50\nfy: 51\ncx: 32\ncy: 24\nwidth: 64\nheight: 48\n");
  EXPECT_THAT(error_of(folder.path()), HasSubstr("--rate HZ"));
}

TEST(ImageSource, PlainFolderWithTimesAsNames) {
  const TemporaryFolder seconds, nanoseconds;
  for (const char* name : {"5.000001.png", "4.500000.png"}) cv::imwrite(seconds / name, picture(1));
  for (const char* name : {"1403636579763555584.png", "1403636579813555456.png"})
    cv::imwrite(nanoseconds / name, picture(1));
  CameraOptions options;
  options.camera_file = seconds / "calibration.yaml";
  write(options.camera_file, kCalibration);
  EXPECT_THAT(times(seconds.path(), options), ElementsAre(4500000, 5000001));
  EXPECT_THAT(times(nanoseconds.path(), options), ElementsAre(1403636579763556, 1403636579813555));
}

TEST(ImageSource, Video) {
  const TemporaryFolder folder;
  const fs::path file = folder / "v.avi";
  cv::VideoWriter writer(file.string(), cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 20, cv::Size(64, 48));
  if (!writer.isOpened()) GTEST_SKIP() << "this OpenCV cannot write a video";
  for (int i = 0; i < 5; ++i) writer.write(picture(i, 64, 48, true));
  writer.release();
  write(folder / "calibration.yaml", kCalibration);
  EXPECT_THAT(times(file), ElementsAre(0, 50000, 100000, 150000, 200000));
  CameraOptions options;
  options.loop = true;
  EXPECT_THAT(times(file, options, 7), ElementsAre(0, 50000, 100000, 150000, 200000, 250000, 300000));
}

TEST(ImageSource, SelectionAndNewTimes) {
  const TemporaryFolder folder;
  write_tum(folder.path(), 10);
  CameraOptions options;
  options.every = 3, options.start_s = 0.2, options.duration_s = 0.6;
  EXPECT_THAT(times(folder.path(), options), ElementsAre(1000200000, 1000500000));
  EXPECT_EQ(open_image_source(folder.path().string(), options).source->total(), 2);
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
  ASSERT_EQ(opened.error, "");
  std::vector<int64_t> utimes;
  while (const std::optional<image_t> image = opened.source->next()) utimes.push_back(image->utime);
  ASSERT_EQ(utimes.size(), 5u);
  const int64_t skipped = opened.source->skipped().total();

  opened.source->play_again({utimes[1], utimes[4], utimes[4] + 1});
  for (const size_t number : {1, 4}) {
    const std::optional<image_t> image = opened.source->next();
    ASSERT_TRUE(image);
    EXPECT_EQ(image->utime, utimes[number]);
    const cv::Mat expected = picture(static_cast<int>(2 * number), 64, 48, /*colour=*/true);
    EXPECT_EQ(cv::norm(decode_bgr(*image, nullptr), expected), 0);
  }
  EXPECT_FALSE(opened.source->next());
  EXPECT_EQ(opened.source->skipped().total(), skipped);
}

TEST(ImageSource, ALoopOfNothingUsableEnds) {
  const TemporaryFolder folder;
  write_tum(folder.path(), 3);
  for (int i = 0; i < 3; ++i) write(folder.path() / fmt::format("rgb/{}.png", i), "no image");
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

TEST(ImageSource, Encodings) {
  const TemporaryFolder folder;
  write_tum(folder.path(), 1, ".jpg");
  const std::string bytes = read(folder / "rgb/0.jpg");
  const auto format = [&folder](const std::string& encoding) {
    CameraOptions options;
    options.encoding = encoding;
    return *open_image_source(folder.path().string(), options).source->next();
  };
  for (const char* as_is : {"auto", "jpeg"}) {
    const image_t image = format(as_is);
    EXPECT_EQ(image.pixelformat, image_t::PIXEL_FORMAT_MJPEG);
    EXPECT_EQ(std::string(image.data.begin(), image.data.end()), bytes);
  }
  EXPECT_EQ(format("grey").pixelformat, image_t::PIXEL_FORMAT_GRAY);
  EXPECT_EQ(format("rgb").pixelformat, image_t::PIXEL_FORMAT_RGB);
  write_tum(folder.path(), 1, ".png");
  EXPECT_EQ(format("auto").pixelformat, image_t::PIXEL_FORMAT_GRAY);
  EXPECT_EQ(format("jpeg").pixelformat, image_t::PIXEL_FORMAT_MJPEG);
  EXPECT_EQ(format("rgb").pixelformat, image_t::PIXEL_FORMAT_RGB);
}

TEST(ImageSource, BadFramesAreLeftOutAndCounted) {
  const TemporaryFolder folder;
  write_tum(folder.path(), 10, ".jpg");
  write(folder / "rgb/2.jpg", read(folder / "rgb/2.jpg").substr(0, 500));
  write(folder / "rgb/3.jpg", "");
  fs::remove(folder / "rgb/4.jpg");
  write(folder / "rgb/5.jpg", std::string(1000, 'x'));
  cv::imwrite(folder / "rgb/6.jpg", picture(6, 32, 48));
  write(folder / "rgb.txt", read(folder / "rgb.txt") + "1000.9 rgb/8.jpg\n50.85 rgb/8.jpg\nabc rgb/9.jpg\n1001.5\n");
  const OpenedSource opened = open_image_source(folder.path().string(), {});
  ASSERT_EQ(opened.error, "");
  EXPECT_THAT(times(*opened.source), ElementsAre(1000000000, 1000100000, 1000700000, 1000800000, 1000900000));
  const SkippedFrames& skipped = opened.source->skipped();
  EXPECT_EQ(skipped.unreadable, 4);
  EXPECT_EQ(skipped.wrong_size, 1);
  EXPECT_EQ(skipped.duplicate, 1);
  EXPECT_EQ(skipped.out_of_order, 1);
  EXPECT_EQ(skipped.malformed, 2);
  EXPECT_THAT(skipped.to_string(), HasSubstr("4 unreadable images"));
}

TEST(ImageSource, TimesInAnotherUnitAreReadAsSuch) {
  const TemporaryFolder folder;
  write_tum(folder / "tum", 4);
  write(folder / "tum/rgb.txt", "1400000000000.0 rgb/0.png\n1400000000033.3 rgb/1.png\n1400000000066.7 rgb/2.png\n");
  EXPECT_THAT(times(folder / "tum"), ElementsAre(1400000000000000, 1400000000033300, 1400000000066700));
  write(folder / "tum/rgb.txt", "timestamp,filename\n5.0,rgb/0.png\n5.1,rgb/1.png\n");
  EXPECT_THAT(times(folder / "tum"), ElementsAre(5000000, 5100000));
  write(folder / "tum/rgb.txt", "5.0 rgb/0.png 5.01 depth/0.png\n5.1 rgb/1.png 5.11 depth/1.png\n");
  EXPECT_THAT(times(folder / "tum"), ElementsAre(5000000, 5100000));
}

TEST(ImageSource, NumbersOfImagesAreNoTimesAndARepeatedLineIsNoImage) {
  const TemporaryFolder folder;
  write_tum(folder.path(), 12);
  std::string list;
  for (int i = 0; i < 12; ++i) list += fmt::format("{} rgb/{}.png\n", i, i);
  write(folder / "rgb.txt", list);
  EXPECT_EQ(times(folder.path()).at(11), 1'100'000) << "at the calibration's fps";
  const std::string good = "5.0 rgb/0.png\n5.0 rgb/0.png\n5.1 rgb/1.png\n5.1 rgb/1.png\n";
  write(folder / "rgb.txt", good);
  const OpenedSource opened = open_image_source(folder.path().string(), {});
  EXPECT_THAT(times(*opened.source), ElementsAre(5000000, 5100000));
  EXPECT_EQ(opened.source->skipped().total(), 0);
}

// A binary file by the name of a list: every letter of a name is looked at more than once.
TEST(ImageSource, ALineOfAMegabyteIsNoImage) {
  const TemporaryFolder folder;
  write_tum(folder.path(), 3);
  write(folder / "rgb.txt", read(folder / "rgb.txt") + "1001 rgb/" + std::string(1 << 20, 'x') + ".png\n");
  const OpenedSource opened = open_image_source(folder.path().string(), {});
  EXPECT_EQ(times(*opened.source).size(), 3u);
  EXPECT_EQ(opened.source->skipped().malformed, 1);
}

TEST(ImageSource, WithARateTimesNeedNotBeThere) {
  const TemporaryFolder folder;
  write_tum(folder.path(), 3);
  CameraOptions options;
  options.rate_hz = 10;
  for (const char* list :
       {"rgb/0.png\nrgb/1.png\nrgb/2.png\n", "-5.0 rgb/0.png\n-4.9 rgb/1.png\n-4.8 rgb/2.png\n",
        "monday rgb/0.png\ntuesday rgb/1.png\nwednesday rgb/2.png\n", "nan rgb/0.png\n1 rgb/1.png\n2 rgb/2.png\n"}) {
    write(folder / "rgb.txt", std::string("# list\n0.0 rgb/0.png\n") + list);
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
  write(folder / "rgb.txt", list);
  const OpenedSource opened = open_image_source(folder.path().string(), {});
  ASSERT_EQ(opened.error, "");
  std::vector<int64_t> streams, utimes;
  while (const std::optional<image_t> image = opened.source->next()) {
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
  write(folder / "rgb.txt", "0 rgb/0.png\n0 rgb/1.png\n0 rgb/2.png\n");
  EXPECT_THAT(error_of(folder.path()), AllOf(HasSubstr("3 images"), HasSubstr("--rate HZ")));
  CameraOptions options;
  options.rate_hz = 10;
  EXPECT_THAT(times(folder.path(), options), ElementsAre(0, 100000, 200000));
}

TEST(ImageSource, ColourAndDepthInOneFolder) {
  const TemporaryFolder folder;
  for (int i = 0; i < 5; ++i) {
    cv::imwrite(folder / fmt::format("frame-{:06}.color.png", i), picture(i));
    cv::imwrite(folder / fmt::format("frame-{:06}.depth.png", i), picture(50 + i));
  }
  write(folder / "calibration.yaml", kCalibration);
  EXPECT_EQ(times(folder.path()).size(), 5u);
  CameraOptions options;
  options.files = "*.depth.png";
  const OpenedSource opened = open_image_source(folder.path().string(), options);
  std::string error;
  EXPECT_EQ(cv::norm(decode_grey(*opened.source->next(), &error), picture(50), cv::NORM_INF), 0);
  options.files = "*.jpg";
  EXPECT_THAT(error_of(folder.path(), options), HasSubstr("fits no image"));
}

TEST(ImageSource, AFolderOfFoldersNamesThoseWithImages) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "image_0");
  cv::imwrite(folder / "image_0/0.png", picture(1));
  write(folder / "calibration.yaml", kCalibration);
  EXPECT_THAT(error_of(folder.path()), AllOf(HasSubstr("no images"), HasSubstr("image_0")));
}

TEST(ImageSource, ALogWithoutImagesOnTheChannelNamesThoseThatHaveSome) {
  const TemporaryFolder folder;
  write(folder / "calibration.yaml", kCalibration);
  const std::vector<uint8_t> image = encode_message(make_grey_image(1'000'000, picture(0)));
  const std::vector<uint8_t> other(20, 7);
  LogWriter with_images(folder / "images.lcm"), without(folder / "none.lcm");
  for (int i = 0; i < 3; ++i) with_images.write(i, "CAMERA_LEFT", image);
  with_images.write(4, "CAMERA", other);
  with_images.write(5, "POSE", other);
  without.write(1, "POSE", other);
  ASSERT_TRUE(with_images.close() && without.close());
  EXPECT_THAT(error_of(folder / "images.lcm"),
              AllOf(HasSubstr("images.lcm: no image on channel 'CAMERA', but 1 other"), HasSubstr("CAMERA_LEFT (3)"),
                    HasSubstr("--set camera_driver.log_channel=CAMERA_LEFT")));
  EXPECT_THAT(error_of(folder / "none.lcm"),
              AllOf(HasSubstr("no channel of it has images"), HasSubstr("it has messages on POSE (1)")));
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
  EXPECT_EQ(opened.source->total(), 9);
  EXPECT_EQ(opened.source->skipped().out_of_order, 1);
  for (int i = 0; i < 9; ++i) {
    const std::optional<image_t> image = opened.source->next();
    std::string error;
    EXPECT_EQ(image->utime, 1'000'000 * (i + 1));
    EXPECT_EQ(cv::norm(decode_grey(*image, &error), picture(i), cv::NORM_INF), 0) << i;
  }
}

TEST(SkippedFrames, ComplainOfMoreThanOnePerCentWithARemedy) {
  SkippedFrames skipped;
  skipped.unreadable = 1;
  EXPECT_TRUE(skipped.complaints(99).empty());
  EXPECT_THAT(skipped.complaints(90),
              ElementsAre(AllOf(HasSubstr("1 of 91 images (1.1 %)"), HasSubstr("record them"))));
  skipped.wrong_size = 50;
  EXPECT_EQ(skipped.complaints(49).size(), 1u);
}

TEST(ImageSource, CorruptPng) {
  const TemporaryFolder folder;
  write_tum(folder.path(), 3);
  const std::string png = read(folder / "rgb/1.png");
  write(folder / "rgb/1.png", png.substr(0, png.size() / 2));
  EXPECT_THAT(times(folder.path()), ElementsAre(1000000000, 1000200000));
}

TEST(ImageSource, RefusesWhatCannotBeUsed) {
  const TemporaryFolder folder;
  write(folder / "empty_list/rgb.txt", "# nothing\n");
  write(folder / "no_file/rgb.txt", "1.0 rgb/0.png\n");
  write(folder / "binary/rgb.txt", std::string("\x00\x01\xff\n\x02", 5));
  write(folder / "empty.lcm", "");
  write(folder / "garbage.mp4", std::string(5000, 'g'));
  for (const char* name : {"empty_list", "no_file", "binary"})
    write(folder.path() / name / "calibration.yaml", kCalibration);
  EXPECT_THAT(error_of(folder / "missing"), AllOf(HasSubstr("missing"), HasSubstr("no such file or folder")));
  EXPECT_THAT(error_of(folder.path()), HasSubstr("no rgb.txt"));
  EXPECT_THAT(error_of(folder / "empty_list"), AllOf(HasSubstr("rgb.txt"), HasSubstr("names no image")));
  EXPECT_THAT(error_of(folder / "binary"), HasSubstr("rgb.txt:1: time is"));
  EXPECT_THAT(error_of(folder / "no_file"), AllOf(HasSubstr("0.png"), HasSubstr("no such file")));
  EXPECT_THAT(error_of(folder / "empty.lcm"), HasSubstr("is empty"));
  EXPECT_THAT(error_of(folder / "binary/rgb.txt"), HasSubstr("give the folder"));
  EXPECT_THAT(error_of(folder / "garbage.mp4"), HasSubstr("neither an lcm log, a ROS bag nor a video"));
  EXPECT_THAT(error_of("/dev/video99"), HasSubstr("there is no such camera"));
  EXPECT_THAT(error_of("/dev/null"), HasSubstr("is not a camera"));
}

TEST(ImageSource, RefusesACalibrationThatDoesNotFit) {
  const TemporaryFolder folder;
  write_tum(folder.path(), 2);
  CameraOptions options;
  options.camera_file = folder / "other.yaml";
  EXPECT_THAT(error_of(folder.path(), options), AllOf(HasSubstr("other.yaml"), HasSubstr("no such file")));
  write(options.camera_file, "fx: 50\nfy: 50\ncx: 32\ncy: 24\nwidth: 640\nheight: 480\n");
  EXPECT_THAT(error_of(folder.path(), options),
              AllOf(HasSubstr("64 x 48"), HasSubstr("640 x 480"), HasSubstr("--camera")));
  write(options.camera_file, "fx: nan\nfy: 50\ncx: 32\ncy: 24\nwidth: 64\nheight: 48\n");
  EXPECT_THAT(error_of(folder.path(), options), HasSubstr("fx is 'nan'"));
  fs::remove(folder / "calibration.yaml");
  EXPECT_THAT(error_of(folder.path()), AllOf(HasSubstr("no calibration"), HasSubstr("--camera FILE")));
}

TEST(ImageSource, NamesTheCameraOfTheFileThatFits) {
  const TemporaryFolder folder;
  write_tum(folder.path(), 2);
  const auto camera = [](int number, int width, int height) {
    return fmt::format("cam{}: {{camera_model: pinhole, intrinsics: [50, 51, 32, 24], resolution: [{}, {}]}}\n", number,
                       width, height);
  };
  CameraOptions options;
  options.camera_file = folder / "camchain.yaml";
  write(options.camera_file, camera(0, 80, 60) + camera(1, 64, 48));
  EXPECT_THAT(error_of(folder.path(), options), AllOf(HasSubstr("80 x 60"), HasSubstr("camchain.yaml:cam1")));
  options.camera_file += ":cam1";
  EXPECT_EQ(open_recording(folder.path().string(), options).error, "");
}

TEST(ImageSource, TakesTheBlockOfTheImagesSize) {
  const TemporaryFolder folder;
  write_tum(folder.path(), 2);
  const auto block = [](int width, int height) {
    return fmt::format(
        " Intrinsic of \"Color\" / {0}x{1} / {{RGB8}}\n  Width: {0}\n  Height: {1}\n  PPX: 32\n  PPY: 24\n  Fx: 50\n  "
        "Fy: 51\n"
        "  Distortion: Brown Conrady\n  Coeffs: 0 0 0 0 0\n\n",
        width, height);
  };
  CameraOptions options;
  options.camera_file = folder / "d435.txt";
  write(options.camera_file, block(80, 60) + block(64, 48));
  const OpenedSource opened = open_recording(folder.path().string(), options);
  ASSERT_EQ(opened.error, "");
  EXPECT_EQ(opened.source->camera().width, 64);
}

TEST(ImageSource, RealDatasetsOpen) {
  const char* variable = std::getenv("RUMI_DATA_DIR");
  const fs::path data = variable ? fs::path(variable) : fs::path(RUMI_SOURCE_DIR) / "../shared/data";
  if (!fs::exists(data / "redkitchen"))
    GTEST_SKIP() << "*** NOT TESTED: no real recordings in " << data << "; set RUMI_DATA_DIR to their folder";
  const std::pair<const char*, size_t> recordings[] = {{"redkitchen", 1000},
                                                       {"redkitchen_soft", 1000},
                                                       {"hololens", 373},
                                                       {"v1_03_rendered", 2092},
                                                       {"fr3_office_1hz", 17}};
  for (const auto& [name, count] : recordings) EXPECT_EQ(times(data / name, {}, 5000).size(), count) << name;
}

}  // namespace
}  // namespace rumi::camera_driver
