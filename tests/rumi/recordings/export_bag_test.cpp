// SPDX-License-Identifier: BSD-3-Clause
// Writes bags and reads them back. bag_by_rosbag_test.sh reads them with other programs.
#include "rumi/recordings/export_bag.h"

#include <gmock/gmock.h>

#include <map>

#include "bus/wire/calibration.h"
#include "bus/wire/image_codec.h"
#include "camera_driver/open_source.h"
#include "formats/bag/bag_file.h"
#include "formats/camera/camera_file.h"
#include "rumi/recordings/export_recording.h"
#include "rumi/recordings/truth_of_recording.h"
#include "tests/formats/recording.h"

namespace rumi::tool {
namespace {

using namespace testing;
using camera_driver::CameraOptions;
using camera_driver::OpenedSource;
using ::testing::AllOf;
using ::testing::HasSubstr;

struct Played {
  std::vector<image_t> images;
  Camera camera;
};

Played play(const std::string& recording, const CameraOptions& options = {}) {
  const OpenedSource opened = camera_driver::open_recording(recording, options);
  EXPECT_EQ(opened.error_text(), "");
  Played played;
  while (std::optional<image_t> image = opened.has_value() ? (*opened)->next() : std::nullopt)
    played.images.push_back(std::move(*image));
  if (opened.has_value()) played.camera = (*opened)->camera();
  return played;
}

class ExportBag : public ::testing::TestWithParam<const char*> {
 protected:
  ExportBag() { write_tum(folder_.path() / "data", 12); }
  std::string bag() const { return folder_ / (std::string("a") + GetParam()); }
  std::string error_of(const ExportOptions& options) const {
    ::testing::internal::CaptureStderr();
    EXPECT_EQ(run_export(options), 1);
    EXPECT_FALSE(fs::exists(options.file));
    return ::testing::internal::GetCapturedStderr();
  }
  ExportOptions options() const {
    ExportOptions options;
    options.input = folder_ / "data";
    options.file = bag();
    return options;
  }
  void expect_the_same(const CameraOptions& how = {}) {
    const Played before = play(folder_ / "data", how), after = play(bag(), how);
    ASSERT_EQ(before.images.size(), after.images.size());
    for (size_t i = 0; i < before.images.size(); ++i) {
      EXPECT_EQ(before.images[i].utime, after.images[i].utime);
      EXPECT_EQ(before.images[i].pixelformat, after.images[i].pixelformat);
      EXPECT_TRUE(before.images[i].data == after.images[i].data) << i;
    }
    Camera camera = before.camera;
    camera.fps = 0;  // a camera_info has no frame rate
    EXPECT_EQ(camera_to_yaml(camera), camera_to_yaml(after.camera));
  }
  static std::string poses(double first_s) {
    std::string text;
    for (int i = 0; i < 12; ++i) text += fmt::format("{:.6f} {} 2 3 0.5 0.5 0.5 0.5\n", first_s + 0.1 * i, i);
    return text;
  }
  TemporaryFolder folder_;
};
INSTANTIATE_TEST_SUITE_P(OfRos, ExportBag, ::testing::Values(".mcap", ".bag"),
                         [](const auto& one) { return std::string(one.param).substr(1); });

TEST_P(ExportBag, IsReadBackToTheBit) {
  ASSERT_EQ(run_export(options()), 0);
  expect_the_same();
}

TEST_P(ExportBag, JpegsAreTheSameBytes) {
  fs::remove_all(folder_ / "data");
  write_tum(folder_.path() / "data", 12, ".jpg");
  ASSERT_EQ(run_export(options()), 0);
  expect_the_same();
  EXPECT_EQ(play(bag()).images[3].data.size(), fs::file_size(folder_ / "data/rgb/3.jpg"));
}

TEST_P(ExportBag, ColoursAndFisheyesAreKept) {
  for (int i = 0; i < 12; ++i) cv::imwrite(folder_ / fmt::format("data/rgb/{}.png", i), picture(i, 64, 48, true));
  folder_.write(
      "data/calibration.yaml",
      "model: kannala_brandt\nfx: 50\nfy: 51\ncx: 32\ncy: 24\nk1: 0.1\nk2: 0.02\nk3: 0.003\nk4: 0.0004\nwidth: "
      "64\nheight: 48\n");
  ExportOptions colour = options();
  colour.camera.encoding = "rgb";
  ASSERT_EQ(run_export(colour), 0);
  expect_the_same(colour.camera);
}

TEST_P(ExportBag, OfSeveralChunksIsReadBack) {
  CameraOptions large;
  large.camera_file = folder_.write("large.yaml", "fx: 900\nfy: 900\ncx: 640\ncy: 480\nwidth: 1280\nheight: 960\n");
  for (int i = 0; i < 12; ++i) cv::imwrite(folder_ / fmt::format("data/rgb/{}.png", i), picture(i, 1280, 960));
  ExportOptions these = options();
  these.camera = large;
  ASSERT_EQ(run_export(these), 0);
  EXPECT_GT(12 * 1280 * 960, 2 * kChunkBytes);
  const Played after = play(bag());
  ASSERT_EQ(after.images.size(), 12u);
  EXPECT_TRUE(after.images[11].data == play(folder_ / "data", large).images[11].data);
}

// The chunks are small, because damage costs all messages of a chunk.
TEST_P(ExportBag, HasSmallChunks) {
  ExportOptions these = options();
  these.camera.camera_file =
      folder_.write("large.yaml", "fx: 300\nfy: 300\ncx: 160\ncy: 120\nwidth: 320\nheight: 240\n");
  for (int i = 0; i < 12; ++i) cv::imwrite(folder_ / fmt::format("data/rgb/{}.png", i), picture(i, 320, 240));
  ASSERT_EQ(run_export(these), 0);
  std::map<int32_t, int64_t> bytes_in_chunk;
  open_bag_file(bag())->scan([&](const BagMessage& message) {
    bytes_in_chunk[message.place.chunk] += message.place.bytes;
    return true;
  });
  if (GetParam() == std::string(".bag")) return;  // its chunks are not compressed and look like one
  EXPECT_EQ(bytes_in_chunk.size(), 2u);
  for (const auto& [chunk, bytes] : bytes_in_chunk) EXPECT_LT(bytes, 1'000'000);
}

TEST_P(ExportBag, HasThePosesOfARun) {
  folder_.write("out/trajectory.txt", poses(1000));
  ExportOptions with_poses = options();
  with_poses.poses = folder_ / "out";
  ASSERT_EQ(run_export(with_poses), 0);
  expect_the_same();
  const TruthFile read = read_truth(bag(), {});
  ASSERT_EQ(read.error, "");
  ASSERT_EQ(read.poses.size(), 12u);
  EXPECT_EQ(read.poses[4].utime_us, 1'000'400'000);
  EXPECT_EQ(read.poses[4].map_from_cam.translation, Eigen::Vector3d(4, 2, 3));
  EXPECT_EQ(read.poses[4].map_from_cam.rotation.coeffs(), Eigen::Vector4d::Constant(0.5));
}

// The bag also has messages that our own reader does not use. Their topics and types are tested.
TEST_P(ExportBag, HasPosesForOthersToo) {
  ExportOptions with_poses = options();
  with_poses.poses = folder_.write("poses.txt", poses(1000));
  ASSERT_EQ(run_export(with_poses), 0);
  const auto read = open_bag_file(bag());
  int64_t visited = 0;
  read->scan([&](const BagMessage&) {
    ++visited;
    return true;
  });
  std::map<std::string, std::pair<std::string, int64_t>> others;
  for (const auto& [id, count] : read->other_messages())
    others[read->connections().at(id).topic] = {read->connections().at(id).type, count};
  const std::pair<std::string, int64_t> pose = {"geometry_msgs/PoseStamped", 12}, path = {"nav_msgs/Path", 1};
  EXPECT_THAT(others, ::testing::ElementsAre(::testing::Pair("/rumi/path", path), ::testing::Pair("/rumi/pose", pose)));
  EXPECT_EQ(visited, 3 * 12);  // images, camera_info, transforms
  EXPECT_EQ(read->damage().places, 0);
  EXPECT_EQ(read->damage().at_end, "");
}

TEST_P(ExportBag, OfAnotherTopicHasItsCalibrationBesideIt) {
  ExportOptions other = options();
  other.channel = "cam1/image";
  ASSERT_EQ(run_export(other), 0);
  expect_the_same();
  const auto read = open_bag_file(bag());
  read->scan([](const BagMessage&) { return true; });
  std::set<std::string> topics;
  for (const auto& [id, connection] : read->connections()) topics.insert(connection.topic);
  EXPECT_THAT(topics, ::testing::ElementsAre("/cam1/camera_info", "/cam1/image"));
}

TEST_P(ExportBag, PosesOfAnotherRecordingAreRefused) {
  ExportOptions other = options();
  other.poses = folder_.write("poses.txt", poses(5000));
  EXPECT_THAT(error_of(other), AllOf(HasSubstr("none of the 12 poses"), HasSubstr("1000.000 to 1001.100 s")));
  other.poses = folder_ / "data";
  EXPECT_THAT(error_of(other), HasSubstr("data: has no trajectory.txt: give the output folder of a run"));
  other.poses = folder_.write("positions.txt", "1000.0 1 2 3\n1000.1 1 2 3\n1000.2 2 2 3\n");
  EXPECT_THAT(error_of(other), HasSubstr("has no rotations"));
}

TEST_P(ExportBag, ImagesOfTwoKindsAreRefused) {
  cv::imwrite(folder_ / "data/rgb/12.jpg", picture(12));
  std::ofstream(folder_ / "data/rgb.txt", std::ios::app) << "1001.2 rgb/12.jpg\n";
  EXPECT_THAT(error_of(options()), HasSubstr("give --encoding grey"));
  ExportOptions grey = options();
  grey.camera.encoding = "grey";
  EXPECT_EQ(run_export(grey), 0);
}

TEST_P(ExportBag, AFullDiskLeavesNothing) {
  const std::string disk = folder_ / "disk";
  fs::create_directory(disk);
  ExportOptions full = options();
  full.file = disk + "/a" + GetParam();
  const int left = run_on_small_disk(disk, 16 << 10, [&] {
    const int code = run_export(full);
    return code == 1 ? static_cast<int>(std::distance(fs::directory_iterator(disk), fs::directory_iterator())) : 99;
  });
  if (left < 0) GTEST_SKIP() << "no file system of our own can be mounted here";
  EXPECT_EQ(left, 0);
  full.file = folder_ / (std::string("no/such/folder") + GetParam());
  EXPECT_THAT(error_of(full), AllOf(HasSubstr(full.file), HasSubstr("No such file or directory")));
}

TEST(ExportNames, OtherFormatsSayWhatToGive) {
  const TemporaryFolder folder;
  write_tum(folder / "data", 3);
  folder.write("poses.txt", "1000 0 0 0 0 0 0 1\n");
  const auto error_of = [&](const std::string& file) {
    ExportOptions options;
    options.input = folder / "data", options.file = folder / file, options.poses = folder / "poses.txt";
    ::testing::internal::CaptureStderr();
    EXPECT_EQ(run_export(options), 1);
    return ::testing::internal::GetCapturedStderr();
  };
  EXPECT_THAT(error_of("a.db3"), HasSubstr("give NAME.mcap"));
  EXPECT_THAT(error_of("a.lcm"), HasSubstr("--poses are written into bags only"));
}

TEST(Export, ThatIsCalledOffLeavesNothing) {
  const testing::TemporaryFolder folder;
  testing::write_tum(folder.path() / "data", 3);
  const std::atomic<bool> stop = true;
  for (const char* name : {"a.lcm", "a.mcap", "a.bag"}) {
    ExportOptions options{folder / "data", folder / name, "", "", {}};
    options.stop = &stop;
    EXPECT_EQ(run_export(options), 1) << name;
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1) << "the recording alone";
}

}  // namespace
}  // namespace rumi::tool
