// SPDX-License-Identifier: BSD-3-Clause
#include "bus/wire/image_codec.h"
#include "tests/formats/bag/bag_fixture.h"

namespace rumi::camera_driver {
namespace {

using namespace testing;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

bool shows(const image_t& image, const cv::Mat& pixels) {
  const cv::Mat grey = decode_grey(image).value();
  return grey.size() == pixels.size() && cv::norm(grey, pixels, cv::NORM_INF) == 0;
}

TEST_F(Bags, OfEachKindArePlayedWithTheirTimesAndCalibration) {
  for (const std::string& kind : bag_kinds()) {
    SCOPED_TRACE(kind);
    add_usual(kind, 20);
    const std::vector<image_t> images = play(write(kind));
    ASSERT_EQ(images.size(), 20u);
    EXPECT_EQ(images[7].utime, stamp_ns(7) / 1000);
    EXPECT_TRUE(shows(images[7], picture(7)));
    EXPECT_EQ(camera_.fx, 50);
    EXPECT_EQ(camera_.k1, 0.1);
    EXPECT_EQ(skipped_.total(), 0);
  }
}

TEST_F(Bags, AreTheSameWithMessagesOfRos1InAnMcapFile) {
  McapWriter mcap("zstd", "ros1");
  add_usual("ros1 none", 5);
  for (const BagMessageToWrite& message : messages_) mcap.add(message);
  EXPECT_EQ(play(folder_.write("a.mcap", mcap.bytes())).size(), 5u);
}

TEST_F(Bags, AFolderIsWhatItsMetadataLists) {
  add_usual("sqlite", 10);
  const std::vector<BagMessageToWrite> all = messages_;
  messages_ = {all.begin() + 11, all.end()};
  fs::rename(write("sqlite"), folder_ / "r_1.db3");
  messages_ = {all.begin(), all.begin() + 11};
  fs::rename(write("sqlite"), folder_ / "r_0.db3");
  folder_.write(
      "metadata.yaml",
      "rosbag2_bagfile_information:\n  relative_file_paths:\n    - r_0.db3\n    - r/r_1.db3\n    - r_2.db3\n");
  EXPECT_EQ(play(folder_.path()).size(), 10u);
  folder_.write("metadata.yaml", "rosbag2_bagfile_information: [\n");
  EXPECT_EQ(play(folder_.path()).size(), 10u);
  fs::remove(folder_ / "r_0.db3");
  fs::remove(folder_ / "r_1.db3");
  EXPECT_THAT(error_of(folder_.path()), HasSubstr("none of its files"));
  folder_.write("metadata.yaml", "rosbag2_bagfile_information:\n  relative_file_paths: [r_0.db3.zstd]\n");
  folder_.write("r_0.db3.zstd", "x");
  EXPECT_THAT(error_of(folder_.path()), HasSubstr("unzstd"));
}

// The bags have no calibration either, but the fault of the images is reported first.
TEST_F(Bags, OfPixelsThatAreNotReadSaySo) {
  const std::string packet("\0\0\0\1\x67", 5);
  std::vector<uint8_t> unit(packet.begin(), packet.end());
  unit.resize(200);
  const cv::Mat pixels = picture(0, 64, 72);
  std::string narrow = image_message(true, stamp_ns(0), picture(0), "mono8");
  const size_t step = narrow.find(std::string("mono8\0\0", 7)) + 8;
  narrow[step] = 10;
  for (const auto& [type, message, what] :
       {std::tuple{"sensor_msgs/Image", image_message(true, stamp_ns(0), pixels, "nv12"), "'nv12', which is not read"},
        {"sensor_msgs/Image", image_message(true, stamp_ns(0), pixels, "nv21"), "'nv21', which is not read"},
        {"sensor_msgs/Image", narrow, "rows of 10 bytes"},
        {"sensor_msgs/CompressedImage", compressed_message(true, stamp_ns(0), "h264", unit),
         "packet of a video (h264)"},
        {"sensor_msgs/CompressedImage", compressed_message(true, stamp_ns(0), "", unit), "video (H.264 or H.265)"}}) {
    messages_.clear();
    add_info("mcap");
    add("/cam0/image_raw", type, 0, message);
    const std::string error = error_of(write("mcap"));
    EXPECT_THAT(error, AllOf(HasSubstr("none of its images can be used"), HasSubstr(what)));
    EXPECT_THAT(error, Not(HasSubstr("--camera")));
  }
}

TEST_F(Bags, OfNegativeTimesAreRefusedOrGetNewOnes) {
  add_info("mcap");
  for (int i = 0; i < 6; ++i) {
    constexpr uint32_t kMinusThree = 0xfffffffd;
    std::string message = image_message(true, stamp_ns(i), picture(i), "mono8");
    message.replace(4, 4, bytes_of(kMinusThree));
    add("/cam0/image_raw", "sensor_msgs/Image", i, message);
  }
  const std::string file = write("mcap");
  EXPECT_THAT(error_of(file),
              AllOf(HasSubstr("6 of its 6 images have negative times (the first -"), HasSubstr("give --rate HZ")));
  options_.rate_hz = 10;
  EXPECT_EQ(play(file).size(), 6u);
}

TEST_F(Bags, WithoutCameraInfoNeedACalibration) {
  for (int i = 0; i < 3; ++i) add_image("mcap", i);
  const std::string file = write("mcap");
  EXPECT_THAT(error_of(file), HasSubstr("--camera FILE"));
  give_calibration();
  EXPECT_EQ(play(file).size(), 3u);
}

TEST_F(Bags, CameraInfoThatIsAllZeroIsNone) {
  add_info("mcap", {.fx = 0});
  add_image("mcap", 0);
  const std::string file = write("mcap");
  EXPECT_THAT(error_of(file), AllOf(HasSubstr("give --camera FILE"), HasSubstr("/cam0/camera_info is all zero")));
  folder_.write("calibration.yaml", kCalibration);
  EXPECT_EQ(play(file).size(), 1u);
  EXPECT_EQ(camera_.fy, 51);
  fs::remove(folder_ / "calibration.yaml");
  give_calibration();
  EXPECT_EQ(play(file).size(), 1u);
  options_.camera_file.clear();
  add_info("mcap");  // a later camera_info has a calibration
  EXPECT_EQ(play(write("mcap")).size(), 1u);
  EXPECT_EQ(camera_.fx, 50);
}

TEST_F(Bags, CameraGoesBeforeTheirCameraInfo) {
  add_info("mcap", {.fx = 55});
  add_image("mcap", 0);
  give_calibration();
  EXPECT_EQ(play(write("mcap")).size(), 1u);
  EXPECT_EQ(camera_.fx, 50);
}

TEST_F(Bags, CameraInfoOfAnotherModelIsRefused) {
  for (const char* kind : {"ros1 none", "mcap"}) {
    messages_.clear();
    add_info(kind, {.model = "rational_polynomial", .d = {0, 0, 0, 0, 0, 1, 0, 0}});
    add_image(kind, 0);
    EXPECT_THAT(error_of(write(kind)), HasSubstr("rational model")) << kind;
    messages_.clear();
    add_info(kind, {.model = "equidistant", .d = {0.1, 0.2, 0.3, 0.4}});
    add_image(kind, 0);
    play(write(kind));
    EXPECT_EQ(camera_.model, Camera::Model::kKannalaBrandt) << kind;
  }
}

TEST_F(Bags, CameraInfoThatChangesIsToldOf) {
  add_usual("mcap", 3);
  EXPECT_THAT(open_frames(write("mcap"), {}).value()->notes(), ::testing::IsEmpty());
  add_info("mcap", {.fx = 55});
  EXPECT_THAT(open_frames(write("mcap"), {}).value()->notes(),
              ::testing::ElementsAre(HasSubstr("another one at the end")));
  play(write("mcap"));
  EXPECT_EQ(camera_.fx, 50);
}

TEST_F(Bags, RectifiedImagesHaveTheRectifiedCamera) {
  add_info("mcap");
  add_image("mcap", 0, "/cam0/image_rect");
  play(write("mcap"));
  EXPECT_EQ(camera_.fx, 60);
  EXPECT_EQ(camera_.cy, 20);
  EXPECT_EQ(camera_.k1, 0);
}

TEST_F(Bags, OfSeveralCamerasAskForOne) {
  add_usual("ros1 lz4", 0);
  for (int i = 0; i < 3; ++i) add_image("ros1 lz4", i, "/rear/image_raw");
  for (int i = 0; i < 2; ++i) add_image("ros1 lz4", i);
  const std::string file = write("ros1 lz4");
  EXPECT_THAT(error_of(file), AllOf(HasSubstr("/cam0/image_raw (2), /rear/image_raw (3)"),
                                    HasSubstr("camera_driver.log_channel=/cam0/image_raw")));
  options_.log_channel = "/cam0/image_raw";
  EXPECT_EQ(play(file).size(), 2u);
  options_.log_channel = "rear/image_raw";
  give_calibration();
  EXPECT_EQ(play(file).size(), 3u);
  options_.log_channel = "/cam2/image_raw";
  EXPECT_THAT(error_of(file), HasSubstr("no images on '/cam2/image_raw'; it has images on"));
}

// The topics are named as in EuRoC's bags.
TEST_F(Bags, OfTwoCamerasOfOneRigTheFirstIsPlayed) {
  give_calibration();
  for (const auto& [first, second] : {std::pair("/cam0/image_raw", "/cam1/image_raw"),
                                      std::pair("/stereo/left/image_raw", "/stereo/right/image_raw")}) {
    messages_.clear();
    for (int i = 0; i < 3; ++i) add_image("ros1 none", i, second);
    for (int i = 0; i < 2; ++i) add_image("ros1 none", i, first);
    const std::string file = write("ros1 none");
    EXPECT_EQ(play(file).size(), 2u) << first;
    EXPECT_THAT(open_frames(file, {}).value()->notes(),
                ::testing::Contains(HasSubstr(fmt::format("{} is played, and not {}", first, second))));
    options_.log_channel = second;
    EXPECT_EQ(play(file).size(), 3u) << second;
    options_.log_channel = CameraOptions{}.log_channel;
  }
}

TEST_F(Bags, NominalCameraInfoOfAKinectIsToldOf) {
  RosWriter info(false);
  info.header(stamp_ns(0)).number(uint32_t{480}).number(uint32_t{640}).text("plumb_bob").number(uint32_t{0});
  for (const double k : {525., 0., 319.5, 0., 525., 239.5, 0., 0., 1.}) info.real(k);
  for (int i = 0; i < 21; ++i) info.real(0);
  for (int i = 0; i < 6; ++i) info.number(uint32_t{0});
  add("/camera/rgb/camera_info", "sensor_msgs/CameraInfo", 0, info.number(uint8_t{0}).bytes());
  add_image("ros1 none", 0, "/camera/rgb/image_color");
  fs::rename(write("ros1 none"), folder_ / "rgbd_dataset_freiburg2_desk.bag");
  EXPECT_THAT(open_frames(folder_ / "rgbd_dataset_freiburg2_desk.bag", {}).value()->notes(),
              ::testing::Contains(
                  AllOf(HasSubstr("nominal values of the Kinect"), HasSubstr("--camera config/cameras/tum_fr2.yaml"))));
}

TEST_F(Bags, DepthIsNotTakenForTheCamera) {
  give_calibration();
  const std::string depth = image_message(true, stamp_ns(0), cv::Mat(48, 64, CV_32FC1, cv::Scalar(1)), "32FC1");
  add("/cam0/depth", "sensor_msgs/Image", 0, depth);
  EXPECT_THAT(error_of(write("mcap")), HasSubstr("encoding '32FC1'"));
  for (int i = 0; i < 3; ++i) add_image("mcap", i);
  EXPECT_EQ(play(write("mcap")).size(), 3u);
  for (int i = 0; i < 3; ++i) add_image("mcap", i, "/rear/image_raw");
  EXPECT_THAT(error_of(write("mcap")),
              HasSubstr("/cam0/image_raw (3), /rear/image_raw (3), /cam0/depth, depth (1): name one"));
}

TEST_F(Bags, WithoutImagesSayWhatTheyHave) {
  add("/imu", "sensor_msgs/Imu", 0, "x");
  add("/imu", "sensor_msgs/Imu", 1, "x");
  for (const std::string& kind : bag_kinds())
    EXPECT_THAT(error_of(write(kind)), HasSubstr("has messages on /imu [sensor_msgs/Imu] (2)")) << kind;
  messages_.clear();
  for (const std::string& kind : bag_kinds()) EXPECT_THAT(error_of(write(kind)), HasSubstr("it is empty")) << kind;
}

TEST_F(Bags, ImagesWithoutStampsHaveTheTimesOfTheBag) {
  for (const char* kind : {"ros1 bz2", "sqlite"}) {
    messages_.clear();
    add_info(kind);
    for (int i = 0; i < 3; ++i)
      add("/cam0/image_raw", "sensor_msgs/Image", i, image_message(is_ros2(kind), 0, picture(i), "mono8"));
    const std::vector<image_t> images = play(write(kind));
    ASSERT_EQ(images.size(), 3u);
    EXPECT_EQ(images[1].utime, (stamp_ns(1) + kRecordedLater_ns) / 1000) << kind;
  }
}

TEST_F(Bags, CompressedImagesAreFilesInMessages) {
  for (const char* kind : {"ros1 none", "mcap zstd", "sqlite"}) {
    for (const char* extension : {".jpg", ".png"}) {
      messages_.clear();
      add_info(kind);
      std::vector<uint8_t> file;
      cv::imencode(extension, picture(3), file);
      add("/cam0/image_raw/compressed", "sensor_msgs/CompressedImage", 0,
          compressed_message(is_ros2(kind), stamp_ns(0), "mono8; jpeg compressed", file));
      const std::vector<image_t> images = play(write(kind));
      ASSERT_EQ(images.size(), 1u) << kind << extension;
      EXPECT_TRUE(shows(images[0], cv::imdecode(file, cv::IMREAD_GRAYSCALE))) << kind << extension;
      EXPECT_EQ(camera_.fx, 50);
    }
  }
}

TEST_F(Bags, MessagesThatAreCompressedOneByOneAreRead) {
  for (const char* kind : {"sqlite", "mcap none"}) {
    add_usual(kind, 4);
    for (BagMessageToWrite& message : messages_) message.bytes = compressed("zstd", message.bytes);
    const std::vector<image_t> images = play(write(kind));
    ASSERT_EQ(images.size(), 4u) << kind;
    EXPECT_EQ(images[2].utime, stamp_ns(2) / 1000) << kind;
  }
}

TEST_F(Bags, PixelsOf16BitsHaveTheRangeOfTheRecording) {
  add_info("ros1 none");
  for (int i = 0; i < 3; ++i) {
    cv::Mat deep;
    picture(i).convertTo(deep, CV_16U, 4, 1000);
    add("/cam0/image_raw", "sensor_msgs/Image", i, image_message(false, stamp_ns(i), deep, "mono16"));
  }
  options_.grey_range = "1000:2020";
  const std::vector<image_t> images = play(write("ros1 none"));
  ASSERT_EQ(images.size(), 3u);
  EXPECT_TRUE(shows(images[1], picture(1)));
}

TEST_F(Bags, OfOldFormatsAndOtherDatabasesAreToldOf) {
  EXPECT_THAT(error_of(folder_.write("a.bag", "#ROSRECORD V1.1\nxxx")), HasSubstr("of an old format"));
  EXPECT_THAT(
      error_of(folder_.write("e.bag", "#ROSBAG V2.0\n" + Ros1Writer::record(3, {{"encryptor", "rosbag/Aes"}}, ""))),
      HasSubstr("encrypted"));
  EXPECT_THAT(error_of(folder_.write("a.db3", "no database")), HasSubstr("cannot be read as a ROS 2 bag"));
  Database(folder_ / "b.db3").execute("CREATE TABLE t(x)");
  EXPECT_THAT(error_of(folder_ / "b.db3"), HasSubstr("no ROS 2 bag"));
  EXPECT_THAT(error_of(folder_.write("c.bag", "")), HasSubstr("is empty"));
  EXPECT_THAT(error_of(folder_.write("d.mcap", "rubbish")), HasSubstr("no whole record"));
}

}  // namespace
}  // namespace rumi::camera_driver
