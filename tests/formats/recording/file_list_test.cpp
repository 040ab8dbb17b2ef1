// SPDX-License-Identifier: BSD-3-Clause
#include "formats/recording/file_list.h"
#include "formats/recording/folder_contents.h"

#include <gmock/gmock.h>

#include "camera_driver/open_source.h"
#include "tests/formats/recording.h"

namespace rumi::camera_driver {
namespace {

using namespace testing;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

class FileLists : public ::testing::Test {
 protected:
  void image(const std::string& name, int number = 0) const {
    fs::create_directories((folder_.path() / name).parent_path());
    cv::imwrite(folder_ / name, picture(number));
  }
  Result<FileList> read(const std::string& lines) const { return read_tum_list(folder_.write("rgb.txt", lines), {}); }
  FileList tum(const std::string& lines) const { return read(lines).value(); }
  std::string error_of(const std::string& name = "") const { return open_recording(folder_ / name, {}).error_text(); }
  TemporaryFolder folder_;
};

std::vector<std::string> names(const FileList& list) {
  std::vector<std::string> all;
  for (const FileList::Entry& entry : list.entries) all.push_back(entry.file.filename().string());
  return all;
}

std::vector<int64_t> times(const FileList& list) {
  std::vector<int64_t> all;
  for (const FileList::Entry& entry : list.entries) all.push_back(entry.utime_us);
  return all;
}

TEST_F(FileLists, OfLinesWithSeveralImagesTheFirstOneIsPlayed) {
  for (const char* line : {"1.{} l{}.png r{}.png\n", "1.{},l{}.png,r{}.png\n", "1.{} l{}.png 1.5 r{}.png\n",
                           "1.{} l{}.png r{}.png d.tiff\n", "1.{} l{}.png 1.5 r{}.exr\n"}) {
    std::string lines;
    for (int i = 0; i < 3; ++i) lines += fmt::format(fmt::runtime(line), i, i, i);
    const FileList list = tum(lines);
    EXPECT_THAT(names(list), ElementsAre("l0.png", "l1.png", "l2.png")) << line;
    EXPECT_THAT(list.notes, ElementsAre(HasSubstr("images each: the first one is played ('l0.png')"))) << line;
  }
}

TEST_F(FileLists, OfDepthBeforeColourTheColourIsPlayedWithItsTime) {
  for (const char* line : {"1.{} depth/{}.png 2.{} rgb/{}.jpg\n", "1.{} {}_depth.exr 2.{} {}.jpg\n"}) {
    std::string lines;
    for (int i = 0; i < 3; ++i) lines += fmt::format(fmt::runtime(line), i, i, i, i);
    const FileList list = tum(lines);
    EXPECT_THAT(names(list), ElementsAre("0.jpg", "1.jpg", "2.jpg")) << line;
    EXPECT_THAT(times(list), ElementsAre(2000000, 2100000, 2200000)) << line;
    EXPECT_THAT(list.notes, ElementsAre(HasSubstr("that is no depth"))) << line;
  }
}

TEST_F(FileLists, TimesBesideTheImagesAreTheirs) {
  for (const char* name : {"image_0/000000.png", "image_0/000001.png", "image_0/000002.png"}) image(name);
  const auto read_with = [this](const std::string& file, const std::string& text) {
    folder_.write(file, text);
    const FileList list = list_image_folder(folder_ / "image_0", {}).value();
    fs::remove(folder_ / file);
    EXPECT_EQ(list.why_no_times, "") << text;
    EXPECT_THAT(list.notes, Contains(HasSubstr(file))) << text;
    return times(list);
  };
  EXPECT_THAT(read_with("times.txt", "0.000000e+00\n1.037e-01\n2.068e-01\n"), ElementsAre(0, 103700, 206800));
  EXPECT_THAT(read_with("image_0/times.csv", "time\n5.0\n5.1\n5.2\n"), ElementsAre(5000000, 5100000, 5200000));
  EXPECT_THAT(read_with("timestamp.txt", "1400000000000\n1400000000100\n1400000000200\n"),
              ElementsAre(1400000000000000, 1400000000100000, 1400000000200000));
  EXPECT_THAT(read_with("times.txt", "00000 5.0 0.01\r\n00001 5.1 0.01\r\n00002 5.2 0.01\r\n"),
              ElementsAre(5000000, 5100000, 5200000));
  EXPECT_THAT(read_with("times.txt", "2 5.2\n3 9\n1 5.1\n0 5.0\n"), ElementsAre(5000000, 5100000, 5200000));
  EXPECT_THAT(
      read_with("timestamps.txt", "2011-09-26 13:02:25.9643\n2011-09-26 13:02:26.0643\n2011-09-26 13:02:26.1\n"),
      ElementsAre(1317042145964300, 1317042146064300, 1317042146100000));
}

TEST_F(FileLists, TimesBesideTheImagesThatDoNotFitAreNamed) {
  for (const char* name : {"000000.png", "000001.png", "000002.png"}) image(name);
  for (const auto& [text, why] : {std::pair{"0.0\n0.1\n", "2 times, and there are 3 images"},
                                  {"", "no lines"},
                                  {"a1 b\nc d\ne f\n", "not each of its lines is a time"}}) {
    folder_.write("times.txt", text);
    const FileList list = list_image_folder(folder_.path(), {}).value();
    EXPECT_NE(list.why_no_times, "");
    EXPECT_THAT(list.notes, ElementsAre(AllOf(HasSubstr("times.txt is not used"), HasSubstr(why))));
  }
  fs::remove(folder_ / "000000.png");
  fs::rename(folder_ / "000001.png", folder_ / "5.1000.png");
  fs::rename(folder_ / "000002.png", folder_ / "5.2000.png");
  EXPECT_THAT(list_image_folder(folder_.path(), {}).value().notes, ElementsAre(HasSubstr("times.txt is not used")));
}

TEST_F(FileLists, ListsOfOtherSystemsAreRead) {
  for (const char* text : {"1.0 rgb/a.png\r1.1 rgb/b.png\r", "1.0 rgb\\a.png\r\n1.1 rgb\\b.png\r\n",
                           "1.0 \"rgb/a.png\"\n1.1 'rgb/b.png'\n", "\"1.0\",\"rgb/a.png\"\n\"1.1\",\"rgb/b.png\"\n",
                           "1.0 \"rgb/a.png\" \"depth/a.png\"\n1.1 \"rgb/b.png\" \"depth/b.png\"\n",
                           "\xEF\xBB\xBF"
                           "1.0 .\\rgb\\a.png\n1.1 .\\rgb\\b.png"}) {
    const FileList list = tum(text);
    EXPECT_EQ(list.malformed.count, 0) << text;
    ASSERT_EQ(list.entries.size(), 2u) << text;
    EXPECT_EQ(list.entries[1].file.lexically_normal(), folder_.path() / "rgb/b.png") << text;
    EXPECT_EQ(list.entries[1].line, 2) << text;
  }
  EXPECT_THAT(names(tum("1.0 \"the left 1.png\"\n")), ElementsAre("the left 1.png"));
  EXPECT_THAT(read("\xFF\xFE"
                   "1.0 a.png")
                  .error_text(),
              AllOf(HasSubstr("rgb.txt: is text in UTF-16"), HasSubstr("iconv")));
}

TEST_F(FileLists, PointersOfGitLfsSayHowToGetTheImages) {
  folder_.write("1.jpg", "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n");
  write_file(folder_ / "calibration.yaml", kCalibration);
  EXPECT_THAT(error_of(), HasSubstr("git lfs pull"));
}

TEST_F(FileLists, ANameMayHaveSpaces) {
  const FileList list = tum("1.0 the left 1.png\n1.1 the left 2.png\n");
  EXPECT_THAT(names(list), ElementsAre("the left 1.png", "the left 2.png"));
  EXPECT_THAT(list.notes, IsEmpty());
}

TEST_F(FileLists, ADecimalCommaIsUnderstood) {
  for (const char* separator : {" ", ";", "\t", "; "}) {
    const FileList list = tum(fmt::format("1305031102,175304{0}rgb/a.png\n1305031102,211214{0}rgb/b.png\n", separator));
    EXPECT_THAT(times(list), ElementsAre(1305031102175304, 1305031102211214)) << separator;
    EXPECT_THAT(names(list), ElementsAre("a.png", "b.png")) << separator;
    EXPECT_THAT(list.notes, ElementsAre(HasSubstr("2 of its times have a decimal comma")));
  }
}

TEST_F(FileLists, ACommaBetweenTimeAndNumberedNameIsNone) {
  const FileList list = tum("1305031102.1,17.png\n1305031103,18.png\n");
  EXPECT_THAT(times(list), ElementsAre(1305031102100000, 1305031103000000));
  EXPECT_THAT(names(list), ElementsAre("17.png", "18.png"));
}

TEST_F(FileLists, NegativeTimesAskForARate) {
  std::string lines;
  for (int i = 0; i < 9; ++i) lines += fmt::format("{:.1f} {}.png\n", -0.6 + 0.1 * i, i);
  EXPECT_THAT(
      read_tum_list(folder_.write("rgb.txt", lines), {}).error_text(),
      AllOf(HasSubstr("6 of its 9 images have negative times (the first -0.600000 s)"), HasSubstr("give --rate HZ")));
  const ListOptions at_rate = {.files = "", .needs_times = false};
  EXPECT_EQ(read_tum_list(folder_ / "rgb.txt", at_rate).value().entries.size(), 9u);
  write_file(folder_ / "cam0/data.csv", "-3000000000,a.png\n-2950000000,b.png\n");
  EXPECT_THAT(read_euroc_list(folder_ / "cam0/data.csv", {}).error_text(),
              HasSubstr("2 of its 2 images have negative times (the first -3.000000 s)"));
  const FileList few = tum("-1.0 a.png\n1.0 b.png\n1.1 c.png\n");
  EXPECT_EQ(few.malformed.count, 1);
}

TEST_F(FileLists, PicturesOfKindsThatAreNotReadCountAsLeftOut) {
  for (int i = 0; i < 6; ++i) image(fmt::format("IMG_{:04}.jpg", i), i);
  EXPECT_EQ(list_image_folder(folder_.path(), {}).value().not_read, 0);
  for (const char* name : {"IMG_0006.HEIC", "IMG_0007.heic", "IMG_0008.dng"}) folder_.write(name, "x");
  for (const char* name : {"IMG_0001.CR2", "depth_1.exr", "notes.txt", ".IMG_0009.heic"}) folder_.write(name, "x");
  const FileList list = list_image_folder(folder_.path(), {}).value();
  EXPECT_EQ(list.entries.size(), 6u);
  EXPECT_EQ(list.not_read, 3);
  EXPECT_THAT(list.notes,
              ElementsAre(AllOf(HasSubstr("3 of its pictures"), HasSubstr("'IMG_0006.HEIC'"), HasSubstr("mogrify"))));
  write_file(folder_ / "calibration.yaml", kCalibration);
  CameraOptions at_rate;
  at_rate.rate_hz = 10;
  const OpenedSource opened = open_recording(folder_.path().string(), at_rate);
  ASSERT_EQ(opened.error_text(), "");
  EXPECT_EQ((*opened)->skipped().unreadable, 3);
}

TEST_F(FileLists, AnImageThatIsHeicWhateverItsNameSaysSo) {
  std::string bytes(
      "\0\0\0\x18"
      "ftypheic",
      12);
  folder_.write("1.jpg", bytes.append(100, 'x'));
  write_file(folder_ / "calibration.yaml", kCalibration);
  EXPECT_THAT(error_of(), HasSubstr("of the kind HEIC, which is not read: convert it"));
}

TEST_F(FileLists, CopiesOfAFileManagerAreLeftOut) {
  for (const char* name : {"image_0.png", "image_0 (1).png", "image_0 copy.png", "image_0 - Copy.png"}) image(name, 0);
  image("image_1.png", 1);
  const FileList list = list_image_folder(folder_.path(), {}).value();
  EXPECT_THAT(names(list), ElementsAre("image_0.png", "image_1.png"));
  EXPECT_THAT(list.notes, ElementsAre(HasSubstr("3 copies of other images are left out (such as 'image_0 ")));
}

TEST_F(FileLists, WhatIsOnlyNamedLikeACopyIsKept) {
  image("image.png", 0), image("image (1).png", 1), image("image (2).png", 2);
  EXPECT_THAT(list_image_folder(folder_.path(), {}).value().notes, Not(::testing::Contains(HasSubstr("copies"))));
}

TEST_F(FileLists, HexadecimalNamesAreInTheOrderOfTheirValues) {
  std::vector<std::string> expected;
  for (int i = 0; i < 40; ++i) image(expected.emplace_back(fmt::format("{:04x}.png", i)));
  const FileList list = list_image_folder(folder_.path(), {}).value();
  EXPECT_EQ(names(list), expected);
  EXPECT_THAT(list.notes, ElementsAre(HasSubstr("hexadecimal")));
}

TEST_F(FileLists, ACounterOf32BitsGoesOn) {
  EXPECT_THAT(times(tum("4294900000 a.png\n4294933333 b.png\n4294966666 c.png\n32703 d.png\n66036 e.png\n")),
              ElementsAre(4294900000, 4294933333, 4294966666, 4294999999, 4295033332));
  for (const char* name : {"4294900000.png", "4294933333.png", "0000000033.png", "0000033333.png"}) image(name);
  EXPECT_THAT(names(list_image_folder(folder_.path(), {}).value()),
              ElementsAre("4294900000.png", "4294933333.png", "0000000033.png", "0000033333.png"));
}

TEST_F(FileLists, DecimalsWithoutLeadingZerosAreCounts) {
  const FileList list = tum("5.0 a.png\n5.33333 b.png\n5.66666 c.png\n5.100000 d.png\n5.133333 e.png\n");
  EXPECT_THAT(times(list), ElementsAre(5000000, 5033333, 5066666, 5100000, 5133333));
  EXPECT_THAT(list.notes, ElementsAre(HasSubstr("counts without leading zeros")));
  for (const char* count : {"0", "33333", "66666", "100000", "133333"}) image(fmt::format("1400000000.{}.png", count));
  EXPECT_THAT(times(list_image_folder(folder_.path(), {}).value()),
              ElementsAre(1400000000000000, 1400000000033333, 1400000000066666, 1400000000100000, 1400000000133333));
}

TEST_F(FileLists, NamesWithoutTrailingZerosAreInTheOrderOfTheirTimes) {
  for (const char* time : {"5.9333", "5.9666", "6.0", "6.0333", "6.0666", "6.1", "6.1333"})
    image(fmt::format("140000000{}.png", time));
  const FileList list = list_image_folder(folder_.path(), {}).value();
  const std::vector<int64_t> played = times(list);
  EXPECT_EQ(played.size(), 7u);
  EXPECT_TRUE(std::is_sorted(played.begin(), played.end()));
  EXPECT_THAT(list.notes, IsEmpty());
}

TEST_F(FileLists, AFolderWhoseTimesPassMidnightIsPlayedInTheirOrder) {
  for (const char* name : {"00-00-00.033.png", "00-00-00.066.png", "23-59-59.966.png", "23-59-59.999.png"}) image(name);
  const FileList list = list_image_folder(folder_.path(), {}).value();
  EXPECT_THAT(names(list), ElementsAre("23-59-59.966.png", "23-59-59.999.png", "00-00-00.033.png", "00-00-00.066.png"));
  EXPECT_THAT(times(list), ElementsAre(86399966000, 86399999000, 86400033000, 86400066000));
  EXPECT_THAT(list.notes, ElementsAre(HasSubstr("midnight")));
}

TEST_F(FileLists, AFolderOfOtherFilesSaysWhichAndWhatIsRead) {
  for (const char* name : {"1.gif", "2.GIF", "3.heic", "README"}) folder_.write(name, "x");
  EXPECT_EQ(other_files(folder_.path()), "1 without an ending, 2 .gif, 1 .heic");
  EXPECT_THAT(error_of(), AllOf(HasSubstr("2 .gif"), HasSubstr("JPEG, PNG, BMP, TIFF, PGM, PPM or WebP"),
                                HasSubstr("convert them")));
}

TEST_F(FileLists, AFolderSaysWhichOfItsFoldersAndFilesToGive) {
  image("images/front/camera/1.png");
  EXPECT_THAT(error_of(), HasSubstr("images are in its folders images/front/camera: give one of them"));
  EXPECT_THAT(error_of("images"), HasSubstr("front/camera"));
  for (const char* name : {"b.MP4", "a.lcm", "notes.log"}) folder_.write(name, "x");
  EXPECT_THAT(error_of(), AllOf(HasSubstr("in it are a.lcm, b.MP4: give the file itself"), Not(HasSubstr("mogrify"))));
}

TEST_F(FileLists, EurocWithoutItsListIsPlayedByTheNamesOfItsImages) {
  for (int i = 0; i < 4; ++i) image(fmt::format("mav0/cam0/data/14036365797{}3555584.png", i), i);
  write_file(folder_ / "mav0/cam0/sensor.yaml",
             "sensor_type: camera\nresolution: [64, 48]\ncamera_model: pinhole\nintrinsics: [50, 51, 32, 24]\n"
             "distortion_model: radial-tangential\ndistortion_coefficients: [0, 0, 0, 0]\n");
  for (const char* given : {"", "mav0", "mav0/cam0", "mav0/cam0/data"}) {
    const OpenedSource opened = open_recording(folder_ / given, {});
    ASSERT_EQ(opened.error_text(), "") << given;
    EXPECT_EQ((*opened)->total(), 4) << given;
    EXPECT_EQ((*opened)->next()->utime, 1403636579703556) << given;
  }
}

}  // namespace
}  // namespace rumi::camera_driver
