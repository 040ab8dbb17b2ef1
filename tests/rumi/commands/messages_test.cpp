// SPDX-License-Identifier: BSD-3-Clause
// Runs commands with each input and option that is refused. `--gtest_filter=Messages.*` prints what a user reads. Each
// message must name the file, option or value that is wrong, and say what to do.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <cstring>

#include "bus/transport/bus.h"
#include "bus/transport/log_file.h"
#include "bus/wire/image_codec.h"
#include "tests/formats/recording.h"
#include "tests/rumi/commands/end_to_end.h"

namespace rumi::tool {
namespace {

using ::testing::HasSubstr;

struct Case {
  const char* command;  // without "$RUMI/" before it
  int exit_code;
  std::vector<const char*> says;  // texts in the output: what is wrong, and the remedy
};

class Messages : public ::testing::Test {
 protected:
  void file(const std::string& name, const std::string& text) const {
    testing::write_file(folder_.path() / name, text);
  }
  void images(const std::string& folder, const std::vector<std::string>& names) const {
    std::filesystem::create_directories(folder_.path() / folder);
    for (size_t i = 0; i < names.size(); ++i)
      cv::imwrite(folder_ / (folder + "/" + names[i]), testing::picture(static_cast<int>(i)));
  }
  void log(const std::string& name, const std::string& channel, bool has_image) const {
    LogWriter log(folder_ / name);
    const std::vector<uint8_t> image = encode_message(make_grey_image(1'000'000, testing::picture(0)));
    log.write(1, channel, has_image ? image : std::vector<uint8_t>(20));
    log.close();
  }
  // Runs the commands, prints their output, and checks it. No raw text of an exception may be in it.
  void tell(const std::vector<Case>& cases) const {
    for (const Case& one : cases) {
      const Outcome outcome = shell("cd '" + folder_.path().string() + "' && $RUMI/" + one.command);
      fmt::print("$ {}\n{}", one.command, outcome.output);
      EXPECT_EQ(outcome.exit_code, one.exit_code) << one.command << "\n" << outcome.output;
      for (const char* text : one.says) EXPECT_THAT(outcome.output, HasSubstr(text)) << one.command;
      for (const char* raw : {"exception", "OpenCV(", "terminate", "what():", " @ 0x", "[ WARN:"})
        EXPECT_EQ(outcome.output.find(raw), std::string::npos) << one.command << "\n" << outcome.output;
    }
  }
  testing::TemporaryFolder folder_;
};

TEST_F(Messages, OfRecordings) {
  testing::write_tum(folder_.path() / "tum", 3);
  file("c.yaml", testing::kCalibration);
  file("large.yaml", "fx: 50\nfy: 51\ncx: 32\ncy: 24\nwidth: 640\nheight: 480\n");
  file("empty.mp4", "");
  file("list.txt", "1 a.png\n");
  file("r.bag", "#ROSBAG V2.0\n");
  file("r.mcap", "\x89MCAP0\r\n");
  file("r.svo2", "x");
  file("rgbd_dataset_freiburg1_xyz.tgz", "\x1F\x8B");
  file("living_room_traj0_frei_png.tar.gz", "\x1F\x8B");
  file("MH_01_easy.zip", "PK\x03\x04");
  testing::write_tum(folder_.path() / "rgbd_dataset_freiburg2_desk", 3);
  std::filesystem::remove(folder_.path() / "rgbd_dataset_freiburg2_desk/calibration.yaml");
  file("run/trajectory.txt", "1000 0 0 0 0 0 0 1\n");
  file("run/frames.csv", "utime,state,submap,in_map\n");
  file("text.avi", "this is no video\n");
  file("gif/1.gif", "GIF89a");
  file("deep/left/x.txt", "");
  images("deep/left", {"1.png", "2.png"});
  images("counted", {"00.png", "01.png"});
  std::filesystem::create_directory(folder_.path() / "nothing");
  file("broken/rgb.txt", "one two\nthree\n");
  file("same/rgb.txt", "1.0 a.png\n1.0 b.png\n1.0 c.png\n");
  images("same", {"a.png", "b.png", "c.png"});
  file("missing/rgb.txt", "1.0 a.png\n1.1 b.png\n");
  log("other.lcm", "CAMERA_LEFT", true);
  log("none.lcm", "POSE", false);
  tell({
      {"rumi replay nowhere -o out", 1, {"nowhere: no such file or folder", "give a dataset folder"}},
      {"rumi replay nothing -o out", 1, {"nothing: has no rgb.txt", "give a dataset folder"}},
      {"rumi replay gif -o out", 1, {"1 .gif", "JPEG, PNG", "convert"}},
      {"rumi replay deep -o out", 1, {"deep: ", "left: give one of them"}},
      {"rumi replay empty.mp4 -o out", 1, {"empty.mp4: is empty", "give"}},
      {"rumi replay list.txt -o out", 1, {"list.txt: is a text file; give the folder"}},
      {"rumi replay text.avi --camera c.yaml -o out", 1, {"text.avi: ", "give a dataset folder"}},
      {"rumi replay r.bag -o out", 1, {"r.bag: no topic of it has images", "is empty"}},
      {"rumi replay r.mcap -o out", 1, {"r.mcap: no topic of it has images", "is empty"}},
      {"rumi replay r.svo2 -o out", 1, {"r.svo2: is a recording of a ZED camera", "give that"}},
      {"rumi replay rgbd_dataset_freiburg1_xyz.tgz -o out",
       1,
       {"is packed: unpack it (`tar xf rgbd_dataset_freiburg1"}},
      {"rumi replay living_room_traj0_frei_png.tar.gz -o out", 1, {"is packed: unpack it (`tar xf living_room_traj0"}},
      {"rumi import MH_01_easy.zip -o new", 1, {"is packed: unpack it (`unzip MH_01_easy.zip`)"}},
      {"rumi replay rgbd_dataset_freiburg2_desk -o out",
       1,
       {"no calibration", "by its name it is of TUM's freiburg2: give --camera config/cameras/tum_fr2.yaml"}},
      {"rumi export tum -o a.db3", 1, {"a.db3: bags in SQLite are not written: give NAME.mcap"}},
      {"rumi export tum -o a.lcm --poses run", 1, {"--poses are written into bags only: give -o NAME.mcap"}},
      {"rumi export tum -o a.mcap --poses tum", 1, {"tum: has no trajectory.txt: give the output folder of a run"}},
      {"rumi evaluate run", 1, {"run.json: names no recording", "give --groundtruth FILE"}},
      {"rumi evaluate run --groundtruth r.bag", 1, {"r.bag: has no poses of the camera", "groundtruth.txt of TUM"}},
      {"rumi replay /dev/video7 -o out", 1, {"/dev/video7", "make one with `rumi camera_driver` and lcm-logger"}},
      {"rumi replay broken --camera c.yaml -o out",
       1,
       {"broken/rgb.txt: names no image", "expected lines 'seconds path"}},
      {"rumi replay same --camera c.yaml -o out", 1, {"--rate HZ"}},
      {"rumi replay missing --camera c.yaml -o out", 1, {"a.png", "no such file"}},
      {"rumi replay counted --camera tum/rgb.txt -o out", 1, {"tum/rgb.txt"}},
      {"rumi replay tum --camera large.yaml -o out", 1, {"64 x 48", "640 x 480", "--camera"}},
      {"rumi replay counted -o out", 1, {"no calibration", "--camera FILE"}},
      {"rumi replay other.lcm --camera c.yaml -o out", 1, {"'CAMERA'", "camera_driver.log_channel=CAMERA_LEFT"}},
      {"rumi replay none.lcm --camera c.yaml -o out", 1, {"none.lcm: no image", "POSE (1)"}},
      {"rumi replay tum --set 'camera_driver.files=left*' -o out", 1, {"left*", "camera_driver.files"}},
      {"rumi export nowhere -o a.lcm", 1, {"nowhere: no such file or folder", "give"}},
      {"rumi export tum -o c.yaml", 1, {"c.yaml: exists; remove it or give another name"}},
      {"rumi export tum -o no/a.lcm", 1, {"no/a.lcm", "No such file or directory"}},
      {"rumi import tum/rgb.txt -o new", 1, {"tum/rgb.txt: is no lcm log"}},
      {"rumi import other.lcm -o tum", 1, {"tum: exists and is not empty; give another folder"}},
      {"rumi calibrate nowhere -o a.yaml", 1, {"nowhere: no such file or folder", "give"}},
      {"rumi calibrate tum -o a.yaml", 1, {"tum: ", "board"}},
      {"rumi calibrate tum -o no/a.yaml", 1, {"no/a.yaml: there is no folder no"}},
  });
}

TEST_F(Messages, OfCameraFiles) {
  testing::write_tum(folder_.path() / "tum", 2);
  const std::string size = "width: 64\nheight: 48\n", matrix = "fx: 50\nfy: 51\ncx: 32\ncy: 24\n";
  file("empty.yaml", "");
  file("no_fx.yaml", "fy: 51\ncx: 32\ncy: 24\n" + size);
  file("word.yaml", "fx: about 50\nfy: 51\ncx: 32\ncy: 24\n" + size);
  file("far.yaml", "fx: 50\nfy: 51\ncx: 3200\ncy: 24\n" + size);
  file("model.yaml", "model: omni\n" + matrix + size);
  file("k4.yaml", matrix + size + "k4: 0.1\n");
  file("no_size.yaml", matrix);
  file("yaml.yaml", "fx: [50\n");
  file("calib.txt", "P0: 7.2e+02 0 6.1e+02 0 0 7.1e+02 1.8e+02 0 0 0 1 0\n");
  file("numbers.txt", "525.0 0 320\n0 525.0 240\n0 0 1\n");
  file("ost.txt", "# oST version 5.0 parameters\n");
  file("c.npz", "PK\x03\x04");
  file("robot.yaml", "speed: 3\nname: robot\n");
  file("kalibr.yaml",
       "cam0:\n  camera_model: omni\n  intrinsics: [1.2, 50, 51, 32, 24]\n  distortion_model: radtan\n  "
       "distortion_coeffs: [0, 0, 0, 0]\n  resolution: [64, 48]\n");
  file("transforms.json", R"({"camera_angle_x": 0.7, "frames": []})");
  tell({
      {"rumi replay tum --camera nowhere.yaml -o out", 1, {"nowhere.yaml: no such file", "--camera FILE"}},
      {"rumi replay tum --camera tum -o out", 1, {"tum: is a folder; give the calibration file"}},
      {"rumi replay tum --camera empty.yaml -o out", 1, {"empty.yaml: is empty", "expected"}},
      {"rumi replay tum --camera no_fx.yaml -o out", 1, {"no_fx.yaml: fx is missing: add"}},
      {"rumi replay tum --camera word.yaml -o out", 1, {"word.yaml: fx is", "about 50", "must be"}},
      {"rumi replay tum --camera far.yaml -o out", 1, {"far.yaml: cx is 3200", "correct it"}},
      {"rumi replay tum --camera model.yaml -o out", 1, {"model.yaml: model is 'omni'", "pinhole"}},
      {"rumi replay tum --camera k4.yaml -o out", 1, {"k4.yaml: k4 is 0.1", "correct the model"}},
      {"rumi replay tum --camera no_size.yaml -o out", 1, {"no_size.yaml: width is missing: add"}},
      {"rumi replay tum --camera yaml.yaml -o out", 1, {"yaml.yaml: is not correct YAML", "expected"}},
      {"rumi replay tum --camera calib.txt -o out", 1, {"calib.txt: is KITTI's", "write fx: 720"}},
      {"rumi replay tum --camera numbers.txt -o out", 1, {"numbers.txt: has numbers without names", "write"}},
      {"rumi replay tum --camera ost.txt -o out", 1, {"ost.txt: is ROS's ost.txt: give the ost.yaml"}},
      {"rumi replay tum --camera c.npz -o out", 1, {"c.npz: is an archive", "write its numbers"}},
      {"rumi replay tum --camera robot.yaml -o out", 1, {"robot.yaml: ", "speed, name", "write its numbers"}},
      {"rumi replay tum --camera kalibr.yaml -o out", 1, {"kalibr.yaml", "omni", "calibrate with"}},
      {"rumi replay tum --camera tum/calibration.yaml:cam1 -o out", 1, {"one camera only: give it without ':cam1'"}},
      {"rumi replay tum --camera transforms.json -o out", 1, {"transforms.json: ", "add w and h"}},
  });
}

TEST_F(Messages, OfMasks) {
  testing::write_tum(folder_.path() / "tum", 2);
  cv::imwrite(folder_ / "small.png", testing::picture(1, 32, 24));
  cv::imwrite(folder_ / "black.png", cv::Mat(48, 64, CV_8U, cv::Scalar(0)));
  cv::imwrite(folder_ / "a.jpg", testing::picture(1));
  file("c.yaml", std::string(testing::kCalibration) + "mask: gone.png\n");
  file("list.yaml", std::string(testing::kCalibration) + "mask: [a.png]\n");
  log("a.lcm", "CAMERA", true);
  std::filesystem::create_directory(folder_.path() / "nothing");
  tell({
      {"rumi replay tum --mask nowhere.png -o out", 1, {"nowhere.png: no such file", "give a PNG"}},
      {"rumi replay tum --mask small.png -o out", 1, {"small.png: the mask is 32 x 24", "are 64 x 48", "make it"}},
      {"rumi export tum --mask black.png -o b.lcm", 1, {"black.png: is black all over", "white is the world"}},
      {"rumi replay tum --mask a.jpg -o out", 1, {"a.jpg: is not a PNG; give a PNG of the images' size"}},
      {"rumi replay tum --mask nothing -o out", 1, {"nothing: has no mask of any image: looked for nothing/rgb/0.png"}},
      {"rumi replay a.lcm --camera tum/calibration.yaml --mask nothing -o out", 1, {"is a folder", "give one PNG"}},
      {"rumi cut-window tum --gap 0..1 --mask small.png -o a.window", 1, {"small.png: the mask is 32 x 24"}},
      {"rumi replay tum --camera c.yaml -o out", 1, {"gone.png: no such file", "give a PNG"}},
      {"rumi replay tum --camera list.yaml -o out", 1, {"mask is a list: must be the name of a PNG file"}},
      {"rumi up --mask small.png", 2, {"--mask: there is no INPUT"}},
      {"rumi mask tum", 2, {"--output is required"}},
      {"rumi mask nowhere -o m.png", 1, {"nowhere: no such file"}},
      {"rumi mask nothing -o m.png", 1, {"nothing: has no rgb.txt"}},
      {"rumi mask tum -o no/m.png", 1, {"no/m.png: there is no folder no"}},
      {"rumi mask tum -o m.jpg", 1, {"m.jpg: must be a PNG: give NAME.png"}},
      {"rumi mask tum -o black.png", 1, {"black.png: exists; remove it or give another name"}},
  });
}

TEST_F(Messages, OfTruthsAndRuns) {
  file("out/frames.csv",
       "utime,state,submap,in_map\n1000000,TRACKING,1,1\n1100000,TRACKING,1,1\n1200000,TRACKING,1,1\n1300000,TRACKING,"
       "1,1\n");
  file("out/trajectory.txt", "1.0 0 0 0 0 0 0 1\n1.1 1 0 0 0 0 0 1\n1.2 2 0 1 0 0 0 1\n1.3 3 1 0 0 0 0 1\n");
  file("empty.txt", "# time tx ty tz\n");
  file("words.txt", "these are\nno poses\n");
  file("later.txt", "1001.0 0 0 0 0 0 0 1\n1001.1 1 0 0 0 0 0 1\n1001.2 1 0 0 0 0 0 1\n1001.3 1 0 0 0 0 0 1\n");
  file("kitti.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n");
  file("no.db", "no database");
  file("map.db", std::string("SQLite format 3\0", 16));
  log("a.lcm", "POSE", false);
  std::filesystem::create_directory(folder_.path() / "nothing");
  tell({
      {"rumi evaluate nowhere --groundtruth later.txt",
       1,
       {"nowhere/trajectory.txt: no such file", "give the output folder"}},
      {"rumi evaluate out --groundtruth nowhere.txt",
       1,
       {"nowhere.txt: no such file", "give the file of the true poses"}},
      {"rumi evaluate out --groundtruth out", 1, {"out: ", "give the file"}},
      {"rumi evaluate out --groundtruth empty.txt", 1, {"empty.txt: holds no poses"}},
      {"rumi evaluate out --groundtruth words.txt", 1, {"words.txt: "}},
      {"rumi evaluate out --groundtruth later.txt",
       1,
       {"later.txt: ", "from 1.000 to 1.300 s", "from 1001.000 to", "give the truth of this recording"}},
      {"rumi evaluate out --groundtruth kitti.txt", 1, {"kitti.txt: ", "--groundtruth-rate"}},
      {"rumi report nowhere", 1, {"nowhere"}},
      {"rumi view nowhere.db -o a.png", 1, {"nowhere.db: there is no such file"}},
      {"rumi view no.db -o a.png", 1, {"no.db"}},
      {"rumi view nothing -o a.png", 1, {"nothing: is a folder without a map.db", "give the output folder of a run"}},
      {"rumi export-map a.lcm -o out --format ply", 1, {"a.lcm: is an lcm log and no map", "rumi export"}},
      {"rumi export-map a.db -o o --format tum --images nothing", 2, {"--images", "leave it out"}},
      {"rumi export-map a.db -o o --format ply --rate 30", 2, {"no --images", "leave them out"}},
      {"rumi export map.db -o b.lcm", 1, {"map.db: is a database and no recording", "rumi export-map"}},
      {"rumi export-map nowhere.db -o out --format ply", 1, {"nowhere.db: there is no such file"}},
      {"rumi ruminate nowhere.window", 1, {"nowhere.window"}},
      {"rumi ruminate nothing", 1, {"nothing: no *.window in it"}},
      {"rumi draw-window nowhere.window -o a.png", 1, {"nowhere.window"}},
      {"rumi cut-window nowhere --gap 1..3 -o a.window", 1, {"nowhere: no such file"}},
      {"rumi cut-window nowhere --gap 3..1 -o a.window", 2, {"3..1"}},
  });
}

TEST_F(Messages, OfVersions) {
  const std::string ours = shell("$RUMI/rumi --version").output;
  EXPECT_THAT(ours, ::testing::MatchesRegex("rumi [0-9.]+\ncommit [0-9a-z+]+\nlibraries: .*OpenCV [0-9].*\n"));
  const std::string version_and_commit = ours.substr(strlen("rumi"), ours.find("\nlibraries") - strlen("rumi"));
  for (const std::string process : {"camera_driver", "front_tracker", "ruminator", "map_server", "viewer_offscreen"})
    EXPECT_EQ(shell("$RUMI/" + process + " --version").output, process + version_and_commit + "\n");
}

TEST_F(Messages, OfOptions) {
  testing::write_tum(folder_.path() / "tum", 2);
  file("a.lcm", "");
  file("bad.yaml", "camera_driver:\n  every: none\n");
  file("key.yaml", "camera_driver:\n  evry: 2\n");
  file("yaml.yaml", "camera_driver: [\n");
  file("good.yaml", "");
  file("section.yaml", "fronttracker:\n  keypoints: 500\n");
  file("c.yaml", testing::kCalibration);
  file("mine/trajectory.txt", "my own\n");
  std::vector<Case> cases = {
      {"rumi", 2, {"a command is missing", "rumi --help"}},
      {"rumi relpay tum", 2, {"relpay: there is no such command; did you mean replay?"}},
      {"rumi replay tum", 2, {"rumi replay: --output is required", "Try `rumi replay --help`"}},
      {"rumi replay tum -o out --evry 2", 2, {"--evry: there is no such flag; did you mean --every?"}},
      {"rumi replay tum -o out --config nowhere.yaml", 2, {"nowhere.yaml", "give the YAML file"}},
      {"rumi replay tum -o out --config bad.yaml", 2, {"bad.yaml:2: camera_driver.every = \"none\"", "expected"}},
      {"rumi replay tum -o out --config key.yaml",
       2,
       {"key.yaml:2: camera_driver.evry", "did you mean camera_driver.every?"}},
      {"rumi replay tum -o out --config yaml.yaml", 2, {"yaml.yaml:", "not valid YAML"}},
      {"rumi replay tum -o out --set camera_driver.evry=2",
       2,
       {"camera_driver.evry", "did you mean camera_driver.every?"}},
      {"rumi replay tum -o out --set every", 2, {"--set every: expected KEY=VALUE"}},
      {"rumi replay tum -o out --set camera_driver.encoding=png",
       2,
       {"camera_driver.encoding = \"png\"", "expected one of"}},
      {"rumi replay tum -o out --set camera_driver.grey_range=9:1", 2, {"grey_range is '9:1'", "LOW:HIGH"}},
      {"rumi replay tum -o out --set camera_driver.width=640", 2, {"640 x 0: give both or none"}},
      {"rumi replay tum -o mine --set map_server.localize_only=true --set map_server.database=./mine/map.db",
       2,
       {"mine/map.db: is the map of map_server.database", "choose another folder"}},
      {"rumi up tum -o mine --set map_server.database=mine/map.db", 2, {"mine/map.db: is the map of"}},
      {"rumi up tum --set map_server.localize_only=true --set map_server.database=good.yaml",
       1,
       {"good.yaml: there is no map in it to localize in"}},
      {"rumi up tum -o good.yaml", 1, {"good.yaml", "it is a file; give another name"}},
      {"rumi up tum -o ''", 2, {"--output is empty"}},
      {"rumi replay tum -o ''", 2, {"--output is empty"}},
      {"rumi replay tum -o out --config section.yaml",
       2,
       {"section.yaml:2: fronttracker", "did you mean front_tracker?"}},
      {"map_server --config section.yaml", 2, {"section.yaml:2: fronttracker", "did you mean front_tracker?"}},
      {"rumi replay tum -o out --config c.yaml", 2, {"c.yaml:1: ", "calibration with --camera FILE"}},
      {"rumi replay tum -o good.yaml", 1, {"good.yaml", "it is a file"}},
      {"rumi replay tum -o mine --set map_server.database=kept.db", 1, {"kept.db is not used", "localize_only=true"}},
      {"rumi replay tum -o out --log mine/trajectory.txt",
       1,
       {"--log mine/trajectory.txt: exists and is no lcm log; remove it or give another name"}},
      {"rumi replay tum -o mine", 1, {"mine: trajectory.txt would be overwritten", "choose another folder"}},
      {"rumi export tum -o b.lcm --set camera_driver.loop=true", 2, {"camera_driver.loop is true"}},
      {"rumi up nowhere.yaml tum", 2, {"nowhere.yaml"}},
      {"rumi up good.yaml --speed 2", 2, {"--speed: there is no INPUT"}},
      {"rumi up good.yaml --camera nowhere.yaml", 2, {"nowhere.yaml"}},
      {"rumi up good.yaml -l udpm://239.255.76.67",
       1,
       {"has no port from 1 to 65535", "udpm://239.255.76.67:7667?ttl=0"}},
      {"rumi up good.yaml tum --sped 2", 2, {"--sped: there is no such flag; did you mean --speed?"}},
      {"rumi evaluate tum --truth-shift soon", 2, {"--truth-shift is 'soon'", "seconds, or auto"}},
      {"rumi evaluate tum --groundtruth a --groundtruth-rate -1", 2, {"--groundtruth-rate: '-1' must be"}},
      {"rumi calibrate tum -o a.yaml --every 0", 2, {"--every", "1"}},
      {"rumi calibrate tum -o a.yaml --board 9x7", 2, {"9x7", "charuco:"}},
      {"rumi calibrate tum -o a.yaml --model wide", 2, {"--model", "wide", "fisheye"}},
      {"rumi draw-board -o a.pdf --board 9x7", 2, {"9x7", "charuco:"}},
      {"rumi draw-board -o a.pdf", 0, {"a.pdf: board charuco:9x7:26:19:4X4_50 on a4", "print it at 100 %"}},
      {"rumi synth -o s --seconds 0", 2, {"seconds"}},
      {"rumi synth -o s --walk far", 2, {"far", "loop"}},
      {"rumi synth -o s --hard fog --at 1 --for 1", 2, {"fog", "blur"}},
      {"rumi view a.db -o a.png --view above", 2, {"--view", "above", "top"}},
      {"rumi export-map a.db -o o --format obj", 2, {"--format", "obj", "ply"}},
      {"rumi replay tum -o out --set keypoints=500", 2, {"did you mean front_tracker.keypoints?"}},
      {"front_tracker --set hair=5", 2, {"hair: unknown option", "rumi config"}},
      {"rumi config --set every=2", 2, {"every", "did you mean camera_driver.every?"}},
      {"camera_driver", 2, {"INPUT is required", "Try `rumi camera_driver --help`"}},
      {"rumi camera_driver", 2, {"camera_driver: INPUT is required"}},
      {"rumi map_server extra", 2, {"map_server: ", "extra"}},
      {"rumi front_tracker --help", 0, {"front_tracker.keypoints"}},
      {"rumi camera-driver --list", 2, {"camera-driver: there is no such command; did you mean camera_driver?"}},
      {"camera_driver tum --set camera_driver.grey_range=9:1", 2, {"grey_range is '9:1'", "LOW:HIGH"}},
      {"front_tracker --set front_tracker.keypoint=1", 2, {"front_tracker.keypoint", "did you mean"}},
      {"map_server extra", 2, {"extra"}},
  };
  // All commands that take a recording refuse wrong values in the same way.
  static std::vector<std::string> lines;
  lines.reserve(100);
  for (const char* command :
       {"rumi replay tum -o out", "rumi export tum -o b.lcm", "rumi up good.yaml tum", "camera_driver tum"})
    for (const char* flag : {"--every 0", "--start -1", "--encoding png"})
      lines.push_back(fmt::format("{} {}", command, flag));
  for (const char* flag : {"--every 0", "--start -1"})
    lines.push_back(fmt::format("rumi import a.lcm -o new {}", flag));
  for (const char* command : {"rumi up good.yaml tum", "camera_driver tum"})
    lines.push_back(fmt::format("{} --speed 0", command));
  for (const std::string& line : lines) cases.push_back({line.c_str(), 2, {": expected ", "camera_driver."}});
  tell(cases);
}

// Little output stays in a buffer, so a full disk is noticed only when the program ends.
TEST_F(Messages, OfWhatCannotBePrinted) {
  if (access("/dev/full", W_OK) != 0) GTEST_SKIP() << "SKIPPED: no /dev/full here";
  static std::vector<std::string> lines;
  std::vector<Case> cases;
  const auto commands = {"rumi --help",          "rumi --version",
                         "rumi replay --help",   "rumi config",
                         "camera_driver --list", "rumi camera_driver --help",
                         "map_server --version", "front_tracker --help-expert"};
  lines.reserve(commands.size());
  for (const char* command : commands) {
    lines.push_back(fmt::format("{} >/dev/full", command));
    cases.push_back({lines.back().c_str(), 1, {"cannot write: No space left on device"}});
  }
  cases.push_back({"rumi --version >&-", 1, {"cannot write"}});
  tell(cases);
}

}  // namespace
}  // namespace rumi::tool
