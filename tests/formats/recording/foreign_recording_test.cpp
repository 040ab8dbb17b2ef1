// SPDX-License-Identifier: BSD-3-Clause
#include "formats/recording/foreign_recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <tuple>

#include "camera_driver/open_source.h"
#include "tests/support/temporary_folder.h"

namespace rumi::camera_driver {
namespace {

using namespace std::string_literals;
using rumi::testing::TemporaryFolder;
using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(ForeignRecording, OthersAreKnownByTheirNames) {
  const TemporaryFolder folder;
  EXPECT_THAT(advice_on_foreign_recording(folder.write("walk.SVO2", "x")), HasSubstr("ZED"));
  EXPECT_EQ(advice_on_foreign_recording(folder.write("walk.mp4", "x")), "");
  EXPECT_EQ(advice_on_foreign_recording("/nowhere"), "");
}

TEST(ForeignRecording, PackedFilesSayHowTheyAreUnpacked) {
  const TemporaryFolder folder;
  for (const auto& [name, bytes, how] :
       {std::tuple{"walk.lcm.gz", "\x1F\x8B\x08x"s, "`gunzip -k "},
        {"walk.tgz", "\x1F\x8B\x08x"s, "`tar xf "},
        {"walk.tar.gz", "\x1F\x8B\x08x"s, "`tar xf "},
        {"walk.zip", "PK\x03\x04x"s, "`unzip "},
        {"walk.tar", "x"s, "`tar xf "},
        {"walk.mp4", "version https://git-lfs.github.com/spec/v1\n"s, "git lfs pull"}}) {
    const std::string file = folder.write(name, bytes);
    EXPECT_THAT(open_recording(file, {}).error_text(), AllOf(HasSubstr(file), HasSubstr(how)));
  }
}

TEST(ForeignRecording, AddressesPipesAndPatternsSayWhatToGive) {
  for (const auto& [input, what] : {std::pair{"rtsp://camera/1", "ffmpeg -i rtsp://camera/1 -c copy"},
                                    {"http://camera/a.mp4", "is an address"},
                                    {"file:///tmp/nowhere.mp4", "behind file:// alone"},
                                    {"-", "is a pipe"},
                                    {"/nowhere/%05d.jpg", "is a pattern"},
                                    {"/nowhere/left*.jpg", "is a pattern"}})
    EXPECT_THAT(open_recording(input, {}).error_text(), AllOf(HasSubstr(input), HasSubstr(what)));
  for (const char* name : {"walk.mp4", "50%.mp4", "50% done.mp4", "a//b", "c:/x.mp4"})
    EXPECT_EQ(advice_on_input(name), "");
}

TEST(ForeignRecording, AVideoWithoutItsIndexWasNeverClosed) {
  const TemporaryFolder folder;
  const std::string beginning =
                        "\0\0\0\x10"
                        "ftypisom\0\0\2\0"s,
                    data =
                        "\0\0\0\0"
                        "mdat some pictures"s;
  EXPECT_THAT(open_recording(folder.write("a.mp4", beginning + data), {}).error_text(), HasSubstr("was never closed"));
  EXPECT_THAT(why_no_video(folder.write("b.mp4", beginning + "\0\0\0\x20"
                                                             "mdat abc"s)),
              HasSubstr("was never closed"));
  EXPECT_EQ(why_no_video(folder.write("c.mp4", beginning +
                                                   "\0\0\0\x08"
                                                   "moov"s +
                                                   data)),
            "");
  EXPECT_EQ(why_no_video(folder.write("d.mp4", "no video at all")), "");
  EXPECT_EQ(why_no_video(folder.write("e.mp4", "")), "");
}

}  // namespace
}  // namespace rumi::camera_driver
