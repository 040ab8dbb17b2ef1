// SPDX-License-Identifier: BSD-3-Clause
// Tests small versions of the downloads of TUM RGB-D, EuRoC and ICL-NUIM, given by the folder itself, one above it or
// one inside.
#include "formats/recording/dataset_folder.h"

#include <gmock/gmock.h>

#include "tests/camera_driver/opened_source.h"
#include "tests/formats/downloads.h"

namespace rumi::camera_driver {
namespace {

using namespace testing;
using ::testing::AllOf;
using ::testing::HasSubstr;

class Downloads : public ::testing::Test {
 protected:
  CameraOptions with_camera(double rate_hz = 0) {
    CameraOptions options;
    options.camera_file = folder_.write("c.yaml", kCalibration);
    options.rate_hz = rate_hz;
    return options;
  }
  std::vector<std::string> notes_of(const fs::path& input) { return open_frames(input.string(), {}).value()->notes(); }
  TemporaryFolder folder_;
};

TEST_F(Downloads, TumIsPlayedFromItsFolderAndFromTheOneAbove) {
  const fs::path tum = write_tum_download(folder_.path() / "unpacked");
  for (const fs::path& given : {tum, tum / "", tum.parent_path()})
    EXPECT_THAT(times(given, with_camera()), ::testing::SizeIs(kImagesOfDownload)) << given;
  EXPECT_THAT(notes_of(tum.parent_path()), ::testing::Contains(HasSubstr("the dataset in its folder rgbd_dataset_fr")));
  EXPECT_THAT(error_of(tum), HasSubstr("it is of TUM's freiburg1: give --camera config/cameras/tum_fr1.yaml"));
}

TEST_F(Downloads, TheOneAboveMayHoldTheArchiveButNoSecondRecording) {
  const fs::path tum = write_tum_download(folder_.path() / "unpacked");
  write_file(folder_ / "unpacked/rgbd_dataset_freiburg1_xyz.tgz", "\x1F\x8B");
  fs::create_directory(folder_ / "unpacked/__MACOSX");
  EXPECT_EQ(find_dataset(folder_ / "unpacked").folder, tum);
  write_tum(folder_ / "unpacked/another", 2);
  EXPECT_EQ(find_dataset(folder_ / "unpacked").folder, folder_ / "unpacked");
  EXPECT_THAT(error_of(folder_ / "unpacked"), HasSubstr("has no rgb.txt"));
}

TEST_F(Downloads, EurocIsPlayedAtEachHeight) {
  const fs::path euroc = write_euroc_download(folder_.path() / "unpacked");
  for (const fs::path& given : {euroc.parent_path(), euroc, euroc / "mav0", euroc / "mav0/cam0"}) {
    EXPECT_THAT(times(given), ::testing::SizeIs(kImagesOfDownload)) << given;  // its sensor.yaml has the calibration
    EXPECT_EQ(find_dataset(given).note.empty(), given != euroc.parent_path()) << given;
  }
}

TEST_F(Downloads, IclIsPlayedWithoutAList) {
  const fs::path icl = write_icl_download(folder_.path() / "unpacked");
  for (const fs::path& given : {icl, icl / "rgb", icl.parent_path()})
    EXPECT_THAT(times(given, with_camera(30)), ::testing::SizeIs(kImagesOfDownload)) << given;
  EXPECT_THAT(notes_of(icl), ::testing::Contains(HasSubstr("the images in its folder rgb are played")));
  EXPECT_THAT(error_of(icl), HasSubstr("ICL-NUIM: give --camera config/cameras/icl_nuim.yaml"));
  // The calibration's rate gives the times.
  CameraOptions by_calibration;
  by_calibration.camera_file = folder_.write("fps.yaml", kCalibration);
  EXPECT_THAT(times(icl, by_calibration)[3] - times(icl, by_calibration)[2], 100'000);
}

TEST_F(Downloads, AFolderOfOtherFoldersIsNoDataset) {
  for (const char* name : {"left/a.txt", "left/1.png", "right/1.png"}) write_file(folder_.path() / "deep" / name, "x");
  EXPECT_EQ(find_dataset(folder_ / "deep").folder, folder_ / "deep");
  EXPECT_EQ(find_dataset(folder_ / "nowhere").folder, folder_ / "nowhere");
}

TEST(KnownCameras, AreToldByTheNamesOfTheDownloads) {
  for (const auto& [name, file] :
       std::vector<std::pair<std::string, std::string>>{{"a/rgbd_dataset_freiburg1_room", "tum_fr1"},
                                                        {"rgbd_dataset_freiburg2_desk.bag", "tum_fr2"},
                                                        {"rgbd_dataset_freiburg3_long_office_household/rgb", "tum_fr3"},
                                                        {"living_room_traj2_loop", "icl_nuim"},
                                                        {"traj3_frei_png", "icl_nuim"},
                                                        {"V1_02_medium.bag", "euroc_cam0"},
                                                        {"MH_01_easy/mav0", "euroc_cam0"}}) {
    EXPECT_THAT(advice_on_known_camera("/x/" + name, "CAMERA"), HasSubstr("config/cameras/" + file + ".yaml")) << name;
    EXPECT_TRUE(fs::exists(fs::path(RUMI_SOURCE_DIR) / "config/cameras" / (file + ".yaml")));
  }
  EXPECT_THAT(advice_on_known_camera("/x/V1_02_medium.bag", "/cam1/image_raw"), HasSubstr("cameras/euroc_cam1.yaml"));
  EXPECT_EQ(advice_on_known_camera("/x/my_walk", "CAMERA"), "");
}

}  // namespace
}  // namespace rumi::camera_driver
