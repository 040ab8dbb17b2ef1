// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver/recording/file_list.h"

#include <gmock/gmock.h>

#include "camera_driver/open_source.h"
#include "tests/camera_driver/recording.h"

namespace rumi::camera_driver {
namespace {

using namespace testing;
using ::testing::AllOf;
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
  FileList tum(const std::string& lines) const { return read_tum_list(folder_.write("rgb.txt", lines), {}); }
  std::string error_of(const std::string& name = "") const { return open_recording(folder_ / name, {}).error; }
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
    EXPECT_EQ(list.error, "") << line;
    EXPECT_THAT(names(list), ElementsAre("l0.png", "l1.png", "l2.png")) << line;
    EXPECT_THAT(list.notes, ElementsAre(HasSubstr("images each: the first one is played ('l0.png')"))) << line;
  }
}

TEST_F(FileLists, ANameMayHaveSpaces) {
  const FileList list = tum("1.0 the left 1.png\n1.1 the left 2.png\n");
  EXPECT_THAT(names(list), ElementsAre("the left 1.png", "the left 2.png"));
  EXPECT_THAT(list.notes, IsEmpty());
}

TEST_F(FileLists, ADecimalCommaIsUnderstood) {
  for (const char* separator : {" ", ";", "\t", "; "}) {
    const FileList list = tum(fmt::format("1305031102,175304{0}rgb/a.png\n1305031102,211214{0}rgb/b.png\n", separator));
    EXPECT_EQ(list.error, "");
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

TEST_F(FileLists, CopiesOfAFileManagerAreLeftOut) {
  for (const char* name : {"image_0.png", "image_0 (1).png", "image_0 copy.png", "image_0 - Copy.png"}) image(name, 0);
  image("image_1.png", 1);
  const FileList list = list_image_folder(folder_.path(), {});
  EXPECT_THAT(names(list), ElementsAre("image_0.png", "image_1.png"));
  EXPECT_THAT(list.notes, ElementsAre(HasSubstr("3 copies of other images are left out (such as 'image_0 ")));
}

TEST_F(FileLists, WhatIsOnlyNamedLikeACopyIsKept) {
  image("image.png", 0), image("image (1).png", 1), image("image (2).png", 2);
  EXPECT_THAT(list_image_folder(folder_.path(), {}).notes, Not(::testing::Contains(HasSubstr("copies"))));
}

TEST_F(FileLists, AFolderWhoseTimesPassMidnightIsPlayedInTheirOrder) {
  for (const char* name : {"00-00-00.033.png", "00-00-00.066.png", "23-59-59.966.png", "23-59-59.999.png"}) image(name);
  const FileList list = list_image_folder(folder_.path(), {});
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

TEST_F(FileLists, EurocWithoutItsListIsPlayedByTheNamesOfItsImages) {
  for (int i = 0; i < 4; ++i) image(fmt::format("mav0/cam0/data/14036365797{}3555584.png", i), i);
  write(folder_ / "mav0/cam0/sensor.yaml",
        "sensor_type: camera\nresolution: [64, 48]\ncamera_model: pinhole\nintrinsics: [50, 51, 32, 24]\n"
        "distortion_model: radial-tangential\ndistortion_coefficients: [0, 0, 0, 0]\n");
  for (const char* given : {"", "mav0", "mav0/cam0", "mav0/cam0/data"}) {
    const OpenedSource opened = open_recording(folder_ / given, {});
    ASSERT_EQ(opened.error, "") << given;
    EXPECT_EQ(opened.source->total(), 4) << given;
    EXPECT_EQ(opened.source->next()->utime, 1403636579703556) << given;
  }
}

}  // namespace
}  // namespace rumi::camera_driver
