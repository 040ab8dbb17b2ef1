// SPDX-License-Identifier: BSD-3-Clause
// Runs the programs on bags: the replay of a bag equals that of the recording from which it was made, to the bit.
#include <cmath>
#include <opencv2/imgcodecs.hpp>

#include "tests/formats/bag/write_bag.h"
#include "tests/rumi/commands/replay_fixture.h"

namespace rumi::tool {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class BagsInUse : public ReplayTest {
 protected:
  static void SetUpTestSuite() {
    work_ = new TemporaryFolder;
    sequence_ = render(*work_, "--seconds 4");
  }
  static Outcome run(const std::string& command) {
    return shell("cd '" + work_->path().string() + "' && $RUMI/rumi " + command);
  }
  static void succeed(const std::string& command) {
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.exit_code, 0) << command << "\n" << outcome.output;
  }
  static std::string file(const std::string& name) { return read_file(work_->path() / name); }
};

TEST_F(BagsInUse, AreReplayedToTheBitAndBringTheirTruth) {
  succeed("replay -q sequence -o of_folder");
  ASSERT_GT(file("of_folder/trajectory.txt").size(), 1000u);
  for (const std::string name : {"walk.mcap", "walk.bag"}) {
    const std::string out = "of_" + name;
    succeed("export sequence -o " + name + " --poses sequence/groundtruth.txt");
    succeed("replay -q " + name + " -o " + out);
    EXPECT_EQ(file(out + "/trajectory.txt"), file("of_folder/trajectory.txt")) << name;
    EXPECT_EQ(file(out + "/map.ply"), file("of_folder/map.ply")) << name;
    const Outcome measured = run("evaluate " + out);
    EXPECT_EQ(measured.exit_code, 0) << measured.output;
    EXPECT_THAT(measured.output, AllOf(HasSubstr("truth                                       " + name),
                                       HasSubstr("poses are those of its frame 'camera' in 'map'")));
    succeed("import " + name + " -o imported_" + name);
    succeed("replay -q imported_" + name + " -o again_" + name);
    EXPECT_EQ(file("again_" + name + "/trajectory.txt"), file("of_folder/trajectory.txt")) << name;
    succeed("evaluate again_" + name);
  }
  // A bag that was exported with the poses of a run contains these poses.
  succeed("export sequence -o of_run.mcap --poses of_folder");
  succeed("import of_run.mcap -o of_run");
  const nlohmann::json alike = evaluate(*work_ / "of_folder", *work_ / "of_run/groundtruth.txt");
  EXPECT_LT(alike["ate_se3_rmse_m"].get<double>(), 1e-5);
}

// The bag has two cameras that see the same walk, one of them mirrored.
TEST_F(BagsInUse, LogChannelChoosesAmongTopics) {
  testing::Ros1Writer bag("lz4");
  std::istringstream list(file("sequence/rgb.txt"));
  for (std::string line; std::getline(list, line);) {
    if (line.starts_with('#')) continue;
    std::istringstream fields(line);
    std::string seconds, name;
    fields >> seconds >> name;
    const int64_t time_ns = std::llround(std::stod(seconds) * 1e6) * 1000;
    const cv::Mat image = cv::imread(*work_ / ("sequence/" + name), cv::IMREAD_GRAYSCALE);
    cv::Mat mirrored;
    cv::flip(image, mirrored, 1);
    const auto message = [&](const cv::Mat& pixels) { return testing::image_message(false, time_ns, pixels, "mono8"); };
    bag.add({"/front/image_raw", "sensor_msgs/Image", message(image), time_ns});
    bag.add({"/rear/image_raw", "sensor_msgs/Image", message(mirrored), time_ns});
  }
  testing::write_file(*work_ / "two.bag", bag.bytes());
  const Outcome unnamed = run("replay -q two.bag --camera sequence/calibration.yaml -o none");
  EXPECT_EQ(unnamed.exit_code, 1);
  EXPECT_THAT(unnamed.output, HasSubstr("/front/image_raw (120), /rear/image_raw (120): name one"));
  for (const std::string topic : {"front", "rear"})
    succeed("replay -q two.bag --camera sequence/calibration.yaml --log-channel /" + topic + "/image_raw -o " + topic);
  succeed("replay -q sequence -o decoded --encoding grey");
  EXPECT_EQ(file("front/trajectory.txt"), file("decoded/trajectory.txt"));
  EXPECT_NE(file("rear/trajectory.txt"), file("front/trajectory.txt"));
  EXPECT_GT(file("rear/trajectory.txt").size(), 1000u);
}

}  // namespace
}  // namespace rumi::tool
