// SPDX-License-Identifier: BSD-3-Clause
// Imports bags. Importing lcm logs is tested in tests/camera_driver/camera_node_test.cpp.
#include "rumi/recordings/import_log.h"

#include <gmock/gmock.h>

#include "formats/camera/camera_file.h"
#include "formats/truth/truth.h"
#include "tests/camera_driver/opened_source.h"
#include "tests/formats/bag/bag_fixture.h"

namespace rumi::camera_driver {
namespace {

using namespace testing;
using ::testing::HasSubstr;

class ImportOfABag : public Bags {
 protected:
  std::string import(const std::string& bag, int code = 0) {
    tool::ImportOptions options;
    options.log = bag, options.folder = folder_ / "imported", options.camera = options_;
    fs::remove_all(options.folder);
    ::testing::internal::CaptureStderr();
    EXPECT_EQ(tool::run_import(options), code);
    return ::testing::internal::GetCapturedStderr();
  }
  std::vector<image_t> imported() {
    options_ = {};
    return play(folder_ / "imported");
  }
};

TEST_F(ImportOfABag, IsAFolderWithTheSameImages) {
  for (const std::string& kind : bag_kinds()) {
    SCOPED_TRACE(kind);
    add_usual(kind, 12);
    const std::string bag = write(kind);
    const std::vector<image_t> before = play(bag);
    EXPECT_EQ(import(bag), "");
    const std::vector<image_t> after = imported();
    ASSERT_EQ(after.size(), 12u);
    EXPECT_EQ(after[7].utime, before[7].utime);
    EXPECT_TRUE(after[7].data == before[7].data);
    EXPECT_EQ(camera_.fx, 50);
    EXPECT_EQ(camera_.k1, 0.1);
    EXPECT_FALSE(fs::exists(folder_ / "imported/groundtruth.txt"));
  }
}

TEST_F(ImportOfABag, JpegsAreWrittenAsTheyAre) {
  std::vector<uint8_t> file;
  cv::imencode(".jpg", picture(3), file);
  add_info("mcap zstd");
  add("/cam0/image_raw/compressed", "sensor_msgs/CompressedImage", 0,
      compressed_message(true, stamp_ns(0), "jpeg", file));
  import(write("mcap zstd"));
  EXPECT_EQ(read_file(folder_ / "imported/rgb/1000.000000.jpg"), std::string(file.begin(), file.end()));
}

TEST_F(ImportOfABag, OfSeveralTopicsTakesTheOneThatIsNamed) {
  add_usual("ros1 bz2", 3);
  for (int i = 0; i < 5; ++i) add_image("ros1 bz2", i, "/rear/image_raw");
  const std::string bag = write("ros1 bz2");
  EXPECT_THAT(import(bag, 1), HasSubstr("/cam0/image_raw (3), /rear/image_raw (5): name one"));
  options_.log_channel = "/rear/image_raw";
  give_calibration();
  import(bag);
  EXPECT_EQ(imported().size(), 5u);
  options_.log_channel = "/cam0/image_raw";
  import(bag);
  EXPECT_EQ(imported().size(), 3u);
}

TEST_F(ImportOfABag, WithTransformsHasItsTruth) {
  add_usual("mcap lz4", 4);
  for (int i = 0; i < 4; ++i)
    add("/tf", "tf2_msgs/TFMessage", i,
        transforms_message(true, {{stamp_ns(i), "world", "camera", {1.0 * i, 0.25, 0}, {0, 0, 0.6, 0.8}}}));
  import(write("mcap lz4"));
  const TruthFile truth = read_groundtruth(folder_ / "imported/groundtruth.txt");
  ASSERT_EQ(truth.error, "");
  ASSERT_EQ(truth.poses.size(), 4u);
  EXPECT_EQ(truth.poses[3].utime_us, stamp_ns(3) / 1000);
  EXPECT_EQ(truth.poses[3].map_from_cam.translation, Eigen::Vector3d(3, 0.25, 0));
  EXPECT_NEAR(truth.poses[3].map_from_cam.rotation.z(), 0.6, 1e-12);
}

TEST_F(ImportOfABag, TransformsThatAreNotTheCamerasAreToldOf) {
  add_usual("mcap", 4);
  add("/tf", "tf2_msgs/TFMessage", 0, transforms_message(true, {{stamp_ns(0), "odom", "base"}}));
  EXPECT_THAT(import(write("mcap")), HasSubstr("there is no groundtruth.txt: "));
  EXPECT_EQ(imported().size(), 4u);
}

}  // namespace
}  // namespace rumi::camera_driver
