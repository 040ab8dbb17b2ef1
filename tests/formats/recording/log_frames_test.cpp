// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include "bus/transport/bus.h"
#include "bus/transport/log_file.h"
#include "bus/wire/image_codec.h"
#include "bus/wire/image_stream.h"
#include "camera_driver/open_source.h"
#include "tests/formats/recording.h"

namespace rumi::camera_driver {
namespace {

using namespace testing;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kMark = "\xED\xA1\xDA\x01";  // bytes with which an event begins

std::string calibration(int fx) { return fmt::format("fx: {}\nfy: 51\ncx: 32\ncy: 24\nwidth: 64\nheight: 48\n", fx); }

class LogFrames : public ::testing::Test {
 protected:
  LogFrames() { testing::write_file(folder_ / "calibration.yaml", kCalibration); }
  // Writes a log of n images, 0.1 s apart.
  void write_log(int n) {
    LogWriter log(file_);
    for (int i = 0; i < n; ++i) {
      image_t image = make_grey_image(1'000'000 + 100'000 * i, picture(i));
      change_(i, &image);
      log.write(image.utime, channels::kCamera, encode_message(image));
    }
    ASSERT_TRUE(log.close());
  }
  std::vector<image_t> play() {
    const OpenedSource opened = open_image_source(file_, options_);
    EXPECT_EQ(opened.error_text(), "");
    std::vector<image_t> images;
    while (std::optional<image_t> image = opened.has_value() ? (*opened)->next() : std::nullopt)
      images.push_back(std::move(*image));
    if (opened.has_value()) skipped_ = (*opened)->skipped();
    return images;
  }
  // Returns the position of the i-th event.
  static size_t begin_of(const std::string& bytes, int i) {
    size_t at = 0;
    for (int n = 0; n < i; ++n) at = bytes.find(kMark, at + 1);
    return at;
  }

  TemporaryFolder folder_;
  const std::string file_ = folder_ / "x.lcm";
  std::function<void(int, image_t*)> change_ = [](int, image_t*) {};
  CameraOptions options_;
  SkippedFrames skipped_;
};

TEST_F(LogFrames, GoOnBehindDamage) {
  write_log(40);
  const std::string whole = read_file(file_);
  const auto with = [&](size_t at, size_t length, const std::string& text) {
    std::string bytes = whole;
    return bytes.replace(at, length, text);
  };
  const size_t tenth = begin_of(whole, 10);
  const std::string longer("\0\0\x20\0", 4), too_long("\x7f\xff\xff\xff", 4);
  struct Case {
    const char* what;
    std::string bytes;
    size_t images;
  };
  for (const Case& c : {Case{"bytes between events", with(tenth, 0, std::string(777, 'x')), 40},
                        Case{"bytes that begin like an event", with(tenth, 0, kMark + std::string(777, '\xff')), 40},
                        Case{"the beginning of an event", with(tenth, 4, "oops"), 39},
                        Case{"a length beyond the file", with(tenth + 24, 4, too_long), 39},
                        Case{"a length that hides others", with(tenth + 24, 4, longer), 39},
                        Case{"a piece is missing", with(tenth + 500, 9000, ""), 36}}) {
    testing::write_file(file_, c.bytes);
    EXPECT_EQ(play().size(), c.images) << c.what;
    EXPECT_GE(skipped_.malformed, 1) << c.what;
    EXPECT_FALSE(skipped_.complaints(static_cast<int64_t>(c.images)).empty()) << c.what;
  }
}

TEST_F(LogFrames, AreFoundWhereTheBeginningIsMissing) {
  write_log(40);
  testing::write_file(file_, read_file(file_).substr(5000));
  EXPECT_EQ(play().size(), 38u);
  EXPECT_EQ(skipped_.malformed, 1);
}

TEST_F(LogFrames, OfAnotherSizeAreKeptWhereTheirCalibrationIsOfIt) {
  change_ = [](int i, image_t* image) {
    if (i >= 15) *image = make_grey_image(image->utime, picture(i, 32, 24));
    set_metadata(image, kCalibrationKey,
                 i < 15 ? calibration(50) : "fx: 25\nfy: 25\ncx: 16\ncy: 12\nwidth: 32\nheight: 24\n");
  };
  write_log(30);
  EXPECT_EQ(play().size(), 30u);
  EXPECT_EQ(skipped_.total(), 0);
}

TEST_F(LogFrames, BehindMuchDamageCountAsLost) {
  write_log(100);
  std::string bytes = read_file(file_);
  const size_t from = begin_of(bytes, 20), to = begin_of(bytes, 40);
  bytes.replace(from, to - from, std::string(to - from, '\0'));
  testing::write_file(file_, bytes);
  EXPECT_EQ(play().size(), 80u);
  EXPECT_GE(skipped_.malformed, 15);
}

TEST_F(LogFrames, OfTwoCamerasInTurnAreThoseOfTheFirst) {
  change_ = [](int i, image_t* image) {
    set_metadata(image, kCalibrationKey, calibration(50 + i % 2));
    set_stream(7, image);
  };
  write_log(40);
  const std::vector<image_t> images = play();
  EXPECT_EQ(images.size(), 20u);
  for (const image_t& image : images) EXPECT_THAT(metadata(image, kCalibrationKey), HasSubstr("fx: 50\n"));
  EXPECT_EQ(skipped_.other_camera, 20);
  EXPECT_THAT(skipped_.complaints(20), ElementsAre(HasSubstr("a channel of its own")));
}

TEST_F(LogFrames, OfTwoStreamsInTurnAreThoseOfTheFirst) {
  change_ = [](int i, image_t* image) { set_stream(7 + i % 3, image); };
  write_log(30);
  EXPECT_EQ(play().size(), 10u);
  EXPECT_EQ(skipped_.other_camera, 20);
}

TEST_F(LogFrames, KeepTheirOwnCalibrationWhereItChanges) {
  change_ = [](int i, image_t* image) { set_metadata(image, kCalibrationKey, calibration(i < 15 ? 50 : 60)); };
  write_log(30);
  for (const char* encoding : {"auto", "jpeg"}) {
    options_.encoding = encoding;
    const std::vector<image_t> images = play();
    ASSERT_EQ(images.size(), 30u);
    for (int i = 0; i < 30; ++i)
      EXPECT_THAT(metadata(images[i], kCalibrationKey), HasSubstr(i < 15 ? "fx: 50\n" : "fx: 60\n")) << i;
  }
  options_.camera_file = folder_ / "calibration.yaml";
  EXPECT_EQ(metadata(play().at(20), kCalibrationKey), metadata(play().at(0), kCalibrationKey)) << "that of the user";
}

// Some programs send the calibration only once.
TEST_F(LogFrames, WithoutACalibrationAreOfTheCameraBefore) {
  change_ = [](int i, image_t* image) {
    if (i % 15 == 0) set_metadata(image, kCalibrationKey, calibration(i < 15 ? 70 : 80));
  };
  write_log(30);
  const std::vector<image_t> images = play();
  ASSERT_EQ(images.size(), 30u);
  for (int i = 0; i < 30; ++i)
    EXPECT_THAT(metadata(images[i], kCalibrationKey), HasSubstr(i < 15 ? "fx: 70\n" : "fx: 80\n")) << i;
}

TEST_F(LogFrames, OfNegativeTimesAreRefusedOrGetNewOnes) {
  change_ = [](int i, image_t* image) { image->utime = -3'000'000 + 100'000 * i; };
  write_log(40);
  EXPECT_THAT(
      open_image_source(file_, options_).error_text(),
      AllOf(HasSubstr("30 of its 40 images have negative times (the first -3.000000 s)"), HasSubstr("give --rate HZ")));
  options_.rate_hz = 10;
  const std::vector<image_t> images = play();
  ASSERT_EQ(images.size(), 40u);
  EXPECT_EQ(images[39].utime - images[0].utime, 3'900'000);
}

TEST_F(LogFrames, OfAFewNegativeTimesAreLeftOut) {
  change_ = [](int i, image_t* image) {
    if (i == 7) image->utime = -1;
  };
  write_log(40);
  EXPECT_EQ(play().size(), 39u);
  EXPECT_EQ(skipped_.malformed, 1);
}

TEST_F(LogFrames, OfFormatsThatAreNotReadAreNamedByTheirLetters) {
  fs::remove(folder_ / "calibration.yaml");
  for (const auto& [format, name] : {std::pair{842094158, "842094158 (NV12)"},
                                     {808596553, "808596553 (I420)"},
                                     {357, "357 (GRAY of 16 bits)"},
                                     {0, "is 0: supported"}}) {
    change_ = [format = format](int, image_t* image) {
      image->pixelformat = format;
      set_metadata(image, kCalibrationKey, kCalibration);
    };
    write_log(3);
    EXPECT_THAT(open_image_source(file_, options_).error_text(),
                AllOf(HasSubstr("none of its images can be used"), HasSubstr(name)));
  }
  change_ = [](int, image_t* image) { image->row_stride = 0; };
  write_log(3);
  EXPECT_THAT(open_image_source(file_, options_).error_text(), HasSubstr("row_stride is 0"));
}

}  // namespace
}  // namespace rumi::camera_driver
