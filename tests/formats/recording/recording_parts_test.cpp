// SPDX-License-Identifier: BSD-3-Clause
#include "formats/recording/recording_parts.h"

#include "bus/transport/bus.h"
#include "bus/transport/log_file.h"
#include "bus/wire/image_codec.h"
#include "formats/bag/bag_file.h"
#include "tests/formats/bag/bag_fixture.h"

namespace rumi::camera_driver {
namespace {

using namespace testing;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int kPerPart = 10;

class RecordingParts : public Bags {
 protected:
  // Writes a bag with the images first to first + 9, 0.1 s apart.
  void write_bag_part(const std::string& kind, const std::string& name, int first) {
    messages_.clear();
    if (first == 0) add_info(kind);  // camera_info is only in the first part
    for (int i = first; i < first + kPerPart; ++i) add_image(kind, i);
    fs::rename(write(kind), folder_ / name);
  }
  void write_log_part(const std::string& name, int first, const std::string& channel = channels::kCamera) {
    LogWriter log(folder_ / name);
    for (int i = first; i < first + kPerPart; ++i) {
      image_t image = make_grey_image(stamp_ns(i) / 1000, picture(i));
      if (first == 0) set_metadata(&image, kCalibrationKey, kCalibration);
      log.write(image.utime, channel, encode_message(image));
    }
    ASSERT_TRUE(log.close());
  }
  void expect_all(int parts) {
    const std::vector<image_t> images = play(folder_.path());
    ASSERT_EQ(images.size(), static_cast<size_t>(parts * kPerPart));
    for (size_t i = 0; i < images.size(); ++i) EXPECT_EQ(images[i].utime, stamp_ns(static_cast<int>(i)) / 1000);
    EXPECT_EQ(skipped_.total(), 0);
    EXPECT_THAT(open_frames(folder_.path(), {}).value()->notes(),
                Contains(HasSubstr(fmt::format("its {} files are played as one recording", parts))));
  }
};

TEST_F(RecordingParts, OfBagsAreOneRecordingInTheOrderOfTheirNumbers) {
  struct Case {
    const char *kind, *form;
  };
  for (const Case& c : {Case{"ros1 none", "walk_2026-03-02-10-15-{0}0_{0}.bag"}, Case{"ros1 lz4", "walk_{}.bag"},
                        Case{"sqlite", "rosbag2_2026_03_02-10_15_00_{}.db3"}, Case{"mcap zstd", "{}.mcap"}}) {
    SCOPED_TRACE(c.form);
    for (int part = 0; part < 3; ++part)
      write_bag_part(c.kind, fmt::format(fmt::runtime(c.form), part + 8), part * kPerPart);  // 8, 9, 10
    expect_all(3);
    for (int part = 0; part < 3; ++part) fs::remove(folder_ / fmt::format(fmt::runtime(c.form), part + 8));
  }
}

TEST_F(RecordingParts, OfLogsAreOneRecordingInTheOrderOfTheirTimes) {
  for (const auto& names : {std::vector{"walk.lcm.00", "walk.lcm.01", "walk.lcm.02"},
                            {"walk_1.lcm", "walk_2.lcm", "walk_10.lcm"},
                            {"walk.lcm.2", "walk.lcm.1", "walk.lcm.0"}}) {  // as lcm-logger --rotate names them
    SCOPED_TRACE(names[0]);
    for (int part = 0; part < 3; ++part) write_log_part(names[part], part * kPerPart);
    expect_all(3);
    for (const char* name : names) fs::remove(folder_ / name);
  }
}

TEST_F(RecordingParts, WithoutImagesAreToldOf) {
  write_log_part("walk.lcm.00", 0);
  write_log_part("walk.lcm.01", kPerPart, "OTHER");
  EXPECT_EQ(play(folder_.path()).size(), static_cast<size_t>(kPerPart));
  EXPECT_THAT(open_frames(folder_.path(), {}).value()->notes(),
              Contains(AllOf(HasSubstr("walk.lcm.01"), HasSubstr("OTHER (10)"))));
}

TEST_F(RecordingParts, OneOfThemSaysThatAnotherGoesOn) {
  write_bag_part("sqlite", "walk_0.db3", 0);
  write_bag_part("sqlite", "walk_1.db3", kPerPart);
  write_log_part("walk.lcm.0", kPerPart);
  write_log_part("walk.lcm.1", 0);
  const auto note = [this](const std::string& name) {
    const OpenedReader opened = open_frames(folder_ / name, {});
    const FirstRecorded first = name.ends_with("db3") ? first_recorded_in_bag : first_recorded_in_log;
    return opened ? note_on_next_part(folder_ / name, (*opened)->last_recorded_us().value_or(0), first) : "?";
  };
  EXPECT_THAT(note("walk_0.db3"), HasSubstr("walk_1.db3 beside it goes on where it ends, and is not played"));
  EXPECT_EQ(note("walk_1.db3"), "");
  EXPECT_THAT(note("walk.lcm.1"), HasSubstr("walk.lcm.0 beside it goes on"));
  EXPECT_EQ(note("walk.lcm.0"), "");
}

TEST_F(RecordingParts, OfVideosSayHowToJoinThem) {
  for (const char* name : {"walk_009.mp4", "walk_010.mp4", "walk_012.mp4", "run_011.mp4", "walk_011.mkv"})
    folder_.write(name, "x");
  EXPECT_THAT(note_on_next_video(folder_ / "walk_009.mp4"), AllOf(HasSubstr("walk_010.mp4"), HasSubstr("ffmpeg")));
  EXPECT_EQ(note_on_next_video(folder_ / "walk_010.mp4"), "");
  EXPECT_EQ(note_on_next_video(folder_ / "missing/walk_010.mp4"), "");
}

TEST_F(RecordingParts, FarFromEachOtherAreRecordingsByThemselves) {
  constexpr int kHours = 100'000;  // number of images from the first part to the second
  write_bag_part("mcap", "walk_1.mcap", 0);
  write_bag_part("mcap", "walk_2.mcap", kHours);
  EXPECT_THAT(error_of(folder_.path()), AllOf(HasSubstr("walk_2.mcap was begun 9999.1 s after the end of walk_1.mcap"),
                                              HasSubstr("give one of the files")));
  EXPECT_EQ(note_on_next_part(folder_ / "walk_1.mcap", stamp_ns(9) / 1000 + 5'000'000, first_recorded_in_bag), "");
  fs::remove(folder_ / "walk_1.mcap");
  fs::remove(folder_ / "walk_2.mcap");
  write_log_part("a.lcm.00", 0);
  write_log_part("a.lcm.01", kHours);
  EXPECT_THAT(error_of(folder_.path()), HasSubstr("a.lcm.01 was begun 9999.1 s after"));
}

TEST_F(RecordingParts, AreNoneWhereNamesOrKindsDifferOrImagesLieBeside) {
  write_bag_part("mcap", "walk_0.mcap", 0);
  EXPECT_THAT(parts_in(folder_.path()), IsEmpty()) << "one alone";
  write_bag_part("mcap", "run_1.mcap", kPerPart);
  EXPECT_THAT(parts_in(folder_.path()), IsEmpty());
  EXPECT_THAT(error_of(folder_.path()), HasSubstr("in it are run_1.mcap, walk_0.mcap: give the file itself"));
  fs::rename(folder_ / "run_1.mcap", folder_ / "walk_1.mcap");
  EXPECT_EQ(parts_in(folder_.path()).size(), 2u);
  cv::imwrite(folder_ / "1.png", picture(1));
  EXPECT_THAT(parts_in(folder_.path()), IsEmpty());
  EXPECT_THAT(parts_in(folder_ / "missing"), IsEmpty());
}

TEST_F(RecordingParts, ThatAListNamesAndAreNotThereCountAsLeftOut) {
  write_bag_part("sqlite", "r_0.db3", 0);
  const std::string files = "rosbag2_bagfile_information:\n  relative_file_paths: [r_0.db3, r_1.db3, r_2.db3]\n";
  folder_.write("metadata.yaml", files);
  EXPECT_EQ(play(folder_.path()).size(), static_cast<size_t>(kPerPart));
  EXPECT_EQ(skipped_.unreadable, 2 * kPerPart) << "as many as are in the others";
  EXPECT_THAT(skipped_.complaints(kPerPart), Contains(HasSubstr("20 of 30 images")));
  folder_.write("metadata.yaml", files +
                                     "  topics_with_message_count:\n  - topic_metadata: {name: /cam0/image_raw}\n"
                                     "    message_count: 25\n");
  play(folder_.path());
  EXPECT_EQ(skipped_.unreadable, 15);
}

TEST_F(RecordingParts, ThatTheListDoesNotNameAreToldOf) {
  write_bag_part("sqlite", "r_0.db3", 0);
  write_bag_part("sqlite", "r_1.db3", kPerPart);
  folder_.write("metadata.yaml", "rosbag2_bagfile_information:\n  relative_file_paths: [r_0.db3]\n");
  EXPECT_EQ(play(folder_.path()).size(), static_cast<size_t>(kPerPart));
  EXPECT_THAT(open_frames(folder_.path(), {}).value()->notes(),
              Contains(AllOf(HasSubstr("r_1.db3 is in it and not played"), HasSubstr("ros2 bag reindex"))));
}

}  // namespace
}  // namespace rumi::camera_driver
