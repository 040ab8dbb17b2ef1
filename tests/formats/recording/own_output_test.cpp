// SPDX-License-Identifier: BSD-3-Clause
#include "formats/recording/own_output.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "camera_driver/open_source.h"
#include "tests/support/temporary_folder.h"

namespace rumi::camera_driver {
namespace {

using namespace std::string_literals;
using rumi::testing::TemporaryFolder;
using ::testing::HasSubstr;

TEST(OutputOfARun, IsNoRecording) {
  const TemporaryFolder folder;
  EXPECT_EQ(advice_on_own_output(folder.path()), "");
  folder.write("run.json", "{\n  \"program\": \"rumi\",\n  \"version\": \"1\"\n}\n");
  folder.write("trajectory.png", "x");
  EXPECT_THAT(open_recording(folder.path().string(), {}).error_text(), HasSubstr("is the output folder of a run"));
  const std::string map = folder.write("map.db", "SQLite format 3\0..."s);
  EXPECT_THAT(open_recording(map, {}).error_text(), HasSubstr("rumi export-map"));
  EXPECT_THAT(open_recording(map, {}).error_text(), HasSubstr("localize_only=true --set map_server.database=" + map));
}

TEST(OutputOfARun, InAFolderOfImagesHidesThemNot) {
  const TemporaryFolder folder;
  folder.write("run.json", "{\n  \"program\": \"rumi\"\n}\n");
  folder.write("0001.png", "x");
  EXPECT_EQ(advice_on_own_output(folder.path()), "");
}

TEST(CharacterDevices, AreCamerasIfTheyGiveVideo) {
  for (const char* device : {"/dev/null", "/dev/zero", "/dev/urandom"}) {
    EXPECT_FALSE(is_camera(device)) << device;
    EXPECT_THAT(open_image_source(device, {}).error_text(), HasSubstr("is not a camera, a file or a folder")) << device;
  }
  EXPECT_TRUE(is_camera("/dev/video0"));
}

}  // namespace
}  // namespace rumi::camera_driver
